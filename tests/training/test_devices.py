"""The number of devices changes how fast a training is, and nothing else."""

import json
import socket
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from jaxleas.cli_guard import UsageError
from jaxleas.runs.metrics import read_metrics
from jaxleas.training.devices import choose_devices
from jaxleas.training.processes import connect
from jaxleas.types import InputError

from ..probes.configs import DRIFT, write
from .runs import ROOT, environment, start_training, tiny

PATIENCE = 900  # with a program that hangs [s]
# In a process that has two devices: trains on one and on two, and moves checkpoints between them.
TWO_DEVICES = """
import json, sys
import jax
from jaxleas.runs.checkpoints import Checkpoints
from jaxleas.training.devices import choose_devices
from jaxleas.training.run_config import make_task
from jaxleas.training.trainer import Trainer
from tests.training.runs import tiny

config = tiny()

class Site:
    def __init__(self, count):
        self.trainer = Trainer(config, make_task(config), choose_devices(count, config.ppo))
        self.like = jax.eval_shape(self.trainer.fresh_state)
        fresh = self.trainer.fresh_state()
        self.step = self.trainer.train_step.lower(self.trainer.world, fresh).compile()

    def walk(self, state, updates):
        for _ in range(updates):
            state, metrics = self.step(self.trainer.world, state)
        return state, {name: float(value) for name, value in metrics.items()}

sites = {count: Site(count) for count in (1, 2)}
report = {"flops": {n: site.step.cost_analysis()["flops"] for n, site in sites.items()}}
for first, then in ((1, 1), (2, 2), (2, 1), (1, 2)):
    state, _ = sites[first].walk(sites[first].trainer.fresh_state(), 2)
    spread = len(state.observation.sharding.device_set)
    checkpoints = Checkpoints(f"{sys.argv[1]}/{first}{then}")
    checkpoints.save(1, state, {})
    state = sites[then].trainer.devices.place(checkpoints.latest(sites[then].like)[1])
    state, metrics = sites[then].walk(state, 2)
    checkpoints.save(2, state, {})
    report[f"{first}{then}"] = {"spread": spread, **metrics}
print(json.dumps(report))
"""


@pytest.fixture(scope="module")
def report(tmp_path_factory) -> tuple[dict, Path]:
    folder = tmp_path_factory.mktemp("devices")
    done = subprocess.run(
        [sys.executable, "-c", TWO_DEVICES, str(folder)],
        cwd=ROOT,
        env=environment(devices=2),
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout.splitlines()[-1]), folder


def arrays_of(path: Path) -> dict[str, np.ndarray]:
    newest = max(path.glob("step_*.npz"))
    with np.load(newest) as archive:
        return {name: archive[name] for name in archive.files if name != "manifest"}


@pytest.mark.slow
@pytest.mark.parametrize("way", ["22", "21", "12"])
def test_two_devices_compute_what_one_computes(report, way):
    """Also when a checkpoint of one number of devices is gone on with on another."""
    metrics, folder = report
    one, two = metrics["11"], metrics[way]
    assert two["spread"] == int(way[0])
    for name in one.keys() - {"spread"}:
        assert two[name] == pytest.approx(one[name], rel=1e-3, abs=1e-5), name
    expected, found = arrays_of(folder / "11"), arrays_of(folder / way)
    assert expected.keys() == found.keys()
    for name, value in expected.items():
        np.testing.assert_allclose(found[name], value, rtol=1e-3, atol=1e-4, err_msg=name)


@pytest.mark.slow
def test_each_of_two_devices_has_half_of_the_work(report):
    metrics, _ = report
    one, two = metrics["flops"]["1"], metrics["flops"]["2"]
    assert two < 0.6 * one


def test_devices_that_are_not_there_or_cannot_share_evenly_are_refused(monkeypatch):
    with pytest.raises(InputError, match=r"--devices 3: JAX finds 1 here \(1 x cpu\)"):
        choose_devices(3, tiny().ppo)
    several = choose_devices("all", tiny().ppo).mesh.devices.tolist() * 3
    monkeypatch.setattr("jax.devices", lambda: several)
    with pytest.raises(InputError, match=r"3 devices cannot share the robots evenly.*--devices 2"):
        choose_devices("all", tiny().ppo)  # 32 robots per minibatch


@pytest.mark.parametrize(
    ("coordinator", "process", "sentence"),
    [
        ("here", "0/2", "--coordinator here is not understood"),
        ("here:0", "0/2", "--coordinator here:0 is not understood"),
        (None, "0/2", "--coordinator is missing"),
        ("here:12355", None, "--process is missing"),
        ("here:12355", "2/2", "--process 2/2 is not understood"),
        ("here:12355", "first", "--process first is not understood"),
        ("auto", "0/2", "--coordinator auto is not understood"),
    ],
)
def test_processes_that_are_not_understood_are_refused(coordinator, process, sentence):
    with pytest.raises(InputError, match=sentence):
        connect(coordinator, process)


@pytest.mark.parametrize("given", ["0", "-1", "some"])
def test_a_wrong_number_of_devices_is_refused(given, monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT))
    import train

    with pytest.raises(UsageError, match=r"--devices is .*, but it should be all or a number"):
        train.main(["configs/leas_p1.yaml", f"--devices={given}"])


def test_a_refused_number_of_devices_leaves_nothing(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT))
    import train

    config = str(ROOT / "configs/leas_p1_smoke.yaml")
    with pytest.raises(InputError, match="--devices 3: JAX finds"):
        train.main([config, "--run-dir", str(tmp_path / "run"), "--devices", "3"])
    assert not list(tmp_path.iterdir())


def free_port() -> int:
    with socket.socket() as server:
        server.bind(("127.0.0.1", 0))
        return server.getsockname()[1]


def run_together(*arguments: str, cache: Path) -> tuple[list[int | None], list[str]]:
    """Run two processes of one training; return their exit codes and what they said."""
    where = ["--coordinator", f"127.0.0.1:{free_port()}"]
    both = [
        start_training(*arguments, *where, "--process", f"{index}/2", cache=cache)
        for index in (0, 1)
    ]
    try:
        outputs = [process.communicate(timeout=PATIENCE)[0] for process in both]
    finally:
        for process in both:
            process.kill()
    return [process.returncode for process in both], outputs


def train_together(*arguments: str, cache: Path) -> None:
    codes, outputs = run_together(*arguments, cache=cache)
    assert codes == [0, 0], outputs


@pytest.mark.slow
def test_two_processes_train_as_one_does(tmp_path):
    """Each with its own device; then one process alone goes on with what two have begun."""
    config, cache = write(tmp_path, DRIFT), tmp_path / "cache"
    size = ["--ppo.steps=32768", "--held_out.every=2", "--allow", DRIFT]
    alone, together = tmp_path / "alone", tmp_path / "together"
    process = start_training(str(config), "--run-dir", str(alone), *size, cache=cache)
    assert process.wait(timeout=PATIENCE) == 0
    train_together(str(config), "--run-dir", str(together), *size, cache=cache)
    expected, found = (read_metrics(each / "metrics.jsonl") for each in (alone, together))
    assert [row["step"] for row in found] == [row["step"] for row in expected]
    for one, two in zip(expected, found, strict=True):
        for name in one.keys() - {"seconds"}:
            assert two[name] == pytest.approx(one[name], rel=1e-2, abs=1e-4), name
    assert sorted(each.name for each in together.iterdir()) == sorted(
        each.name for each in alone.iterdir()
    )
    newest = max((together / "checkpoints").glob("step_*.npz"))
    newest.unlink()  # as if it had been interrupted before the last examination
    train_together("--resume", str(together), "--allow", DRIFT, cache=cache)
    for name, value in arrays_of(alone / "checkpoints").items():
        again = arrays_of(together / "checkpoints")[name]
        np.testing.assert_allclose(again, value, rtol=1e-2, atol=1e-3, err_msg=name)


@pytest.mark.slow
def test_what_process_0_cannot_begin_stops_the_other(tmp_path):
    codes, outputs = run_together("--resume", str(tmp_path / "missing"), cache=tmp_path)
    assert codes == [2, 2], outputs
    assert "does not exist" in outputs[0]
    assert "process 0 could not begin" in outputs[1]
