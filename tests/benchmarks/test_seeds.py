"""Several seeds, judged: what is worst of them, and going on after an interruption."""

import json

import pytest

from benchmarks import seeds
from benchmarks.measurements import read_measurements
from benchmarks.seed_rows import rows_of_cells
from jaxleas.cli_guard import run_guarded
from jaxleas.configuration import to_yaml
from jaxleas.evaluation import CellResult, Evaluation, write_evaluation
from jaxleas.terrain import noise_of
from jaxleas.training import load_run_config

SMOKE = seeds.ROOT / "configs" / "leas_p1_smoke.yaml"


def cell(name, reached, invalid, expectation="cross", starts=40):
    return CellResult(
        **{"name": name, "yaw": 0.0, "method": "leas_p1", "starts": starts},
        **{"reached": reached, "invalid": invalid, "stopped": 1.0 - reached - invalid},
        **{"low": 0.0, "high": 1.0, "expectation": expectation},
    )


def evaluation(run, suite, *cells):
    """An evaluation of the policy that lies in a run folder."""
    return Evaluation(
        **{"suite": suite, "policy": str(run), "seed": 0, "robot": "talos"},
        fingerprint=seeds.hashlib.sha256((run / "policy.npz").read_bytes()).hexdigest(),
        **{"created": "2026-01-01T00:00:00", "seconds": 1.0, "cells": cells},
    )


@pytest.fixture
def commands(monkeypatch):
    """Commands that were run, in place of minutes of training; the second training stops."""
    ran, stops = [], [2]

    def run(*words):
        ran.append(list(map(str, words)))
        if words[0] == "train.py":
            resumed = words[1] == "--resume"
            folder = words[2] if resumed else words[words.index("--run-dir") + 1]
            folder.mkdir(parents=True, exist_ok=True)
            if not resumed:
                seed = words[words.index("--seed") + 1]
                stated = load_run_config(SMOKE, ["--seed", str(seed)])
                (folder / "config.yaml").write_text(to_yaml(stated))
            config = load_run_config(folder / "config.yaml")
            (folder / "policy.npz").write_bytes(str(config.seed).encode())
            stops[0] -= 1
            done = config.ppo.updates if stops[0] else 1
            row = {"step": done * config.ppo.batch, "seconds": 3.0}
            (folder / "metrics.jsonl").write_text(json.dumps(row) + "\n")
            if not stops[0]:
                raise seeds.InterruptedBenchmarkError("stopped")
        else:
            folder, suite = words[3], words[5]
            seed = load_run_config(folder / "config.yaml").seed
            found = cell("rim", 0.9 + 0.01 * seed, 0.02 - 0.01 * seed)
            (folder / "evaluation").mkdir(exist_ok=True)
            write_evaluation(
                folder / "evaluation" / f"{suite}.json", evaluation(folder, suite, found)
            )

    monkeypatch.setattr(seeds, "_run", run)
    return ran


def test_an_interrupted_benchmark_goes_on_where_it_stopped(commands, tmp_path, capsys):
    arguments = [
        *(str(SMOKE), "--seeds", "0", "1", "--runs", str(tmp_path / "runs")),
        *("--suites", "hole", "--starts", "40", "--out", str(tmp_path / "seeds.json")),
        *("--cells", str(tmp_path / "cells.json")),
    ]
    assert run_guarded(lambda: seeds.main(arguments)) == 2
    assert not (tmp_path / "seeds.json").exists()
    before = len(commands)
    assert run_guarded(lambda: seeds.main(arguments)) == 0
    again = commands[before:]
    assert [each[:2] for each in again] == [["train.py", "--resume"], ["-m", "jaxleas.cli"]]
    (hole,) = read_measurements(tmp_path / "seeds.json")
    assert (hole.name, hole.value, hole.runs) == ("hole_worst", 90.0, (90.0, 91.0))
    document = json.loads((tmp_path / "cells.json").read_text())
    (row,) = document["cells"]
    assert row["worst_success"] == 0.9
    assert row["median_success"] == pytest.approx(0.905)
    assert row["worst_invalid"] == 0.02
    assert document["seconds"] == {"0": 3.0, "1": 3.0}
    assert "| hole | rim | 0° | 90.0 / 90.5 % | 2.0 / 1.5 % |" in capsys.readouterr().out


def test_where_the_policy_should_stop_staying_valid_is_success(tmp_path):
    (tmp_path / "policy.npz").write_bytes(b"policy")
    found = evaluation(tmp_path, "dead_end", cell("wall", 0.0, 0.04, "stop"))
    trained = [seeds.Trained(seed, 1.0, (found,)) for seed in (0, 1)]
    (row,) = seeds.cells_of(trained)
    assert row["worst_success"] == pytest.approx(0.96)


def test_rows_are_of_the_worst_cell_of_the_worst_seed(tmp_path):
    (tmp_path / "policy.npz").write_bytes(b"policy")
    found = [
        [
            evaluation(
                tmp_path, "dead_end", cell("void", 0.0, 0.01, "stop"), cell("wall", 0.0, bad)
            ),
            evaluation(
                tmp_path,
                "limits",
                cell("gap_crossable", good, 0.0),
                cell("gap_hopeless", 0.0, 0.02, "stop"),
            ),
        ]
        for bad, good in ((0.0, 0.9), (0.03, 0.95))
    ]
    trained = [seeds.Trained(seed, 1.0, tuple(each)) for seed, each in enumerate(found)]
    rows = {row.name: row for row in rows_of_cells(seeds.cells_of(trained), "a machine")}
    assert set(rows) == {
        "dead_end_0_worst_invalid",
        "limits_worst_invalid",
        "limits_crossable_worst",
    }
    assert rows["dead_end_0_worst_invalid"].runs == (1.0, 3.0)
    assert rows["dead_end_0_worst_invalid"].value == 3.0
    assert rows["limits_worst_invalid"].value == 2.0
    assert rows["limits_crossable_worst"].value == 90.0
    assert {row.machine for row in rows.values()} == {"a machine"}


def test_transitions_with_noise_have_rows_and_a_file_of_their_own(tmp_path):
    (tmp_path / "policy.npz").write_bytes(b"policy")
    (tmp_path / "evaluation").mkdir()
    noise = noise_of(seeds.NOISE)
    turned = cell("rim", 0.5, 0.0).model_copy(update={"yaw": 180.0})
    plain = evaluation(tmp_path, "transitions", cell("rim", 1.0, 0.0))
    noisy = evaluation(tmp_path, "transitions", cell("rim", 0.95, 0.0), turned)
    noisy = noisy.model_copy(update={"noise": noise})
    rows = rows_of_cells(seeds.cells_of([seeds.Trained(0, 1.0, (plain, noisy))]), "a machine")
    values = {row.name: row.value for row in rows}
    assert values == {"transitions_worst": 100.0, "noise_0_worst": 95.0, "noise_180_worst": 50.0}
    for found, counts in ((noisy, True), (plain, False)):  # an older file without noise does not
        write_evaluation(tmp_path / "evaluation" / f"{seeds.NOISY}.json", found)
        assert (seeds.kept(tmp_path, seeds.NOISY, 40) is not None) == counts


def test_an_evaluation_of_another_policy_or_of_fewer_starts_does_not_count(tmp_path):
    (tmp_path / "policy.npz").write_bytes(b"policy")
    (tmp_path / "evaluation").mkdir()
    found = evaluation(tmp_path, "hole", cell("rim", 0.9, 0.0))
    write_evaluation(tmp_path / "evaluation" / "hole.json", found)
    assert seeds.kept(tmp_path, "hole", 40) == found
    assert seeds.kept(tmp_path, "hole", 41) is None
    (tmp_path / "policy.npz").write_bytes(b"another")
    assert seeds.kept(tmp_path, "hole", 40) is None


def test_a_seed_named_twice_is_refused(capsys):
    assert run_guarded(lambda: seeds.main(["--seeds", "1", "1"])) == 2
    assert "name each seed once" in capsys.readouterr().err
