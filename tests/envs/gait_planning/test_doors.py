"""Gait planning trains, resumes and is exported through the doors that steering uses."""

import shutil
from typing import Any

import numpy as np
import onnxruntime
import pytest

from jaxleas.configuration import to_yaml
from jaxleas.export import export
from jaxleas.runs import RunFolder, read_metrics
from jaxleas.training import parse_run_config, read_policy, train

TINY = {
    "env": {"task": "gait_planning", "examined_distance": [1.0, 2.0]},
    "terrain": {"arenas": 6, "field": {"length": 4.0, "width": 3.0}},
    "network": {"hidden": [8]},
    "ppo": {
        **{"steps": 192, "environments": 16, "unroll": 4, "minibatches": 2, "epochs": 1},
        "candidates": 64,
    },
    "held_out": {"every": 1, "starts": 12, "arenas": 6, "steps": 3},
    "checkpoints": {"keep_last": 3},
    "watch": [],
}


@pytest.mark.slow
def test_it_trains_resumes_bitwise_and_is_exported(tmp_path, brax_ranks):
    pytest.importorskip("numba")
    config = parse_run_config(TINY, "tiny")
    folder = tmp_path / "whole"
    with RunFolder.create(folder, to_yaml(config), command=["test"]) as run:
        policy = train(config, run)
    rows = read_metrics(folder / "metrics.jsonl")
    assert len(rows) == 3
    assert all("held_out/reached/gaps" in row and "walk/unknown" in row for row in rows)

    again = tmp_path / "again"
    shutil.copytree(folder, again)
    for checkpoint in sorted((again / "checkpoints").glob("step_*.npz"))[1:]:
        checkpoint.unlink()
    with RunFolder.open(again, writing=True) as run:
        train(config, run)
    assert (again / "policy.npz").read_bytes() == (folder / "policy.npz").read_bytes()
    resumed = read_metrics(again / "metrics.jsonl")
    for row in (*rows, *resumed):
        row.pop("seconds")
    assert resumed == rows

    export(folder)
    session = onnxruntime.InferenceSession(str(folder / "policy.onnx"))
    shown: dict[str, Any] = {
        each.name: np.random.default_rng(0).normal(size=(5, *each.shape[1:])).astype(np.float32)
        for each in session.get_inputs()
    }
    assert set(shown) == {"attitude", "velocity", "feet", "contacts", "heights"}
    expected = policy(shown)
    outputs: dict[str, Any] = dict(
        zip((each.name for each in session.get_outputs()), session.run(None, shown), strict=True)
    )
    np.testing.assert_allclose(outputs["phase"], expected, atol=1e-5)
    assert read_policy(folder / "policy.npz")(shown).shape == (5, 16)
