"""Another humanoid steers, is labelled by an exact planner, and is distilled."""

import jax
import numpy as np
import pytest
import yaml

from benchmarks.tiny import BATCH, tiny_training
from jaxleas import cli
from jaxleas.configuration.loading import to_yaml
from jaxleas.distillation.folder import DistillationFolder
from jaxleas.files import read_json
from jaxleas.robots import load_robot
from jaxleas.runs.folder import RunFolder
from jaxleas.runs.metrics import read_metrics
from jaxleas.surrogates import read_surrogate
from jaxleas.training.loop import train
from jaxleas.training.policy import read_policy
from jaxleas.training.run_config import load_run_config

# G1 walks at 0.70 m, Talos at 0.95 m: what is seen lies as much nearer.
G1 = {"robot": "g1", "height_low": -1.05, "height_high": -0.15, "desired_speed": 0.08}
LEVEL = {"generator": {"rows": 3, "columns": 3}, "shares": {"bridge": 0.0}}


@pytest.mark.slow
def test_g1_steers_is_labelled_and_distilled(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    stated = tiny_training(updates=8)
    stated |= {"env": G1, "terrain": {"arenas": 4, **LEVEL}}
    (tmp_path / "g1.yaml").write_text(yaml.safe_dump(stated))
    config = load_run_config("g1.yaml")
    with (
        jax.numpy_rank_promotion("allow"),
        RunFolder.create("start", to_yaml(config), ["train.py"]) as run,
    ):
        train(config, run)
    rows = read_metrics(run.metrics)
    assert rows[-1]["walk/valid_starts"] > 0.3
    assert np.isfinite(rows[-1]["walk/reward"])
    assert read_policy(run.path / "policy.npz").config.robot == "g1"

    (tmp_path / "distill.yaml").write_text(
        "planner: sampling\nparameters: {samples: 2000}\nrounds: 1\n"
        "collect: {guides: 240, steps: 60, disturbances: [0.3, 0.9]}\n"
        "fit: {epochs: 1, code: 8, hidden: 4, held_out: 0.5}\n"
        f"practice: {{steps: {2 * BATCH}}}\njudge: {{suites: [hole], starts: 2}}\n"
    )
    command = ["distill", "distill.yaml", "--out", "out", "--start", "start", "--processes", "1"]
    with jax.numpy_rank_promotion("allow"):
        cli.run(command)
    folder = DistillationFolder(tmp_path / "out")
    (_, first) = read_json(folder.table)["rounds"]
    assert first["labels"] > 0
    assert read_surrogate(folder.surrogate).identity.robot == "g1"
    assert read_policy(folder.policy).config.robot == load_robot("g1").name
