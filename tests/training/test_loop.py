"""A run that stops, by whatever cause, goes on as if it had not."""

import io
import json
import os
import signal
import time

import numpy as np
import pytest
import yaml

from benchmarks.tiny import tiny_training
from jaxleas.runs.checkpoints import Checkpoints
from jaxleas.runs.folder import RunFolder
from jaxleas.training.loop import NonFiniteError, train

from .runs import start_training, tiny


def checkpoint_arrays(folder):
    newest = max((folder / "checkpoints").glob("step_*.npz"))
    with np.load(newest) as archive:
        return newest.name, {name: archive[name] for name in archive.files if name != "manifest"}


@pytest.mark.slow
@pytest.mark.usefixtures("brax_ranks")
def test_a_damaged_best_policy_is_made_again_from_its_checkpoint(tmp_path, caplog):
    path = tmp_path / "run"
    with RunFolder.create(path, "seed: 0\n", ["test"]) as run:
        train(tiny(steps=64 * 10 * 2), run)
    whole = (path / "policy.npz").read_bytes()
    (path / "policy.npz").write_bytes(whole[:-200])
    with RunFolder.open(path, writing=True) as run, caplog.at_level("WARNING"):
        train(tiny(steps=64 * 10 * 2), run)
    assert "made again from the checkpoint of step 1280" in caplog.text
    with np.load(path / "policy.npz") as made, np.load(io.BytesIO(whole)) as kept:
        assert all(made[name].tobytes() == kept[name].tobytes() for name in kept.files)


def rows_of(folder):
    rows = [json.loads(line) for line in (folder / "metrics.jsonl").read_text().splitlines()]
    return [{name: value for name, value in row.items() if name != "seconds"} for row in rows]


def assert_same_run(left, right):
    (left_name, left_arrays), (right_name, right_arrays) = map(checkpoint_arrays, (left, right))
    assert left_name == right_name
    assert left_arrays.keys() == right_arrays.keys()
    for name, value in left_arrays.items():
        assert value.tobytes() == right_arrays[name].tobytes(), name
    assert rows_of(left) == rows_of(right)
    with np.load(left / "policy.npz") as one, np.load(right / "policy.npz") as other:
        assert all(one[name].tobytes() == other[name].tobytes() for name in one.files)


@pytest.mark.usefixtures("brax_ranks")
def test_a_run_leaves_what_it_should(tmp_path):
    config = tiny()
    with RunFolder.create(tmp_path / "run", "seed: 0\n", ["test"]) as run:
        policy = train(config, run)
    rows = rows_of(tmp_path / "run")
    assert [row["step"] for row in rows] == [640 * update for update in range(1, 9)]
    assert all("held_out/reached" in row for row in rows[1::2])
    assert all(row["learn/total_loss"] is not None for row in rows)
    assert policy.config == config.env
    assert Checkpoints(tmp_path / "run" / "checkpoints").steps()[-1] == 640 * 8


@pytest.mark.usefixtures("brax_ranks")
def test_numbers_that_are_not_finite_stop_the_run_and_keep_the_last_good_state(tmp_path):
    import jax

    config = tiny(learning_rate=1e25, final_learning_rate=1e25)
    with (
        RunFolder.create(tmp_path / "run", "seed: 0\n", ["test"]) as run,
        jax.debug_nans(False),
        pytest.raises(NonFiniteError, match=r"update \d+ .* non-finite .* parameters"),
    ):
        train(config, run)
    _name, arrays = checkpoint_arrays(tmp_path / "run")
    assert all(np.all(np.isfinite(value)) for value in arrays.values() if value.dtype.kind == "f")


@pytest.fixture(scope="module")
def uninterrupted(tmp_path_factory):
    """A whole run, the folder of its compile cache, and its configuration file."""
    folder = tmp_path_factory.mktemp("runs")
    config = folder / "tiny.yaml"
    config.write_text(yaml.safe_dump(tiny_training(24)))
    process = start_training(str(config), "--run-dir", str(folder / "whole"), cache=folder / "xla")
    output, _ = process.communicate(timeout=300)
    assert process.returncode == 0, output
    return folder, config


def resume_until_done(folder, cache):
    process = start_training("--resume", str(folder), cache=cache)
    output, _ = process.communicate(timeout=300)
    assert process.returncode == 0, output


@pytest.mark.slow
def test_ctrl_c_saves_and_says_how_to_go_on(uninterrupted):
    folder, config = uninterrupted
    run = folder / "interrupted"
    process = start_training(str(config), "--run-dir", str(run), cache=folder / "xla")
    while not (run / "checkpoints").is_dir() and process.poll() is None:
        time.sleep(0.02)
    time.sleep(1.0)
    os.killpg(process.pid, signal.SIGINT)
    output, _ = process.communicate(timeout=120)
    if process.returncode != 0:  # else it was done before the signal came
        assert process.returncode == 130
        assert f"--resume {run}" in output
        assert "Traceback" not in output
        resume_until_done(run, folder / "xla")
    assert_same_run(folder / "whole", run)
