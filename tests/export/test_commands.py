import json
import shutil
from pathlib import Path

import numpy as np
import pytest

from jaxleas.configuration.loading import to_yaml
from jaxleas.envs.steering import TerrainConfig
from jaxleas.export import recording
from jaxleas.export.commands import export
from jaxleas.export.recording import edge_cases
from jaxleas.files import write_json, write_text
from jaxleas.guide import load_policy
from jaxleas.training.config import HeldOutConfig
from jaxleas.training.policy import write_policy
from jaxleas.training.run_config import run_config_of
from jaxleas.types import InputError
from tests.guide.walkers import random_policy

POLICY = random_policy(seed=4)


@pytest.fixture
def run(tmp_path):
    """A run folder as training leaves it, as far as exporting is concerned."""
    config = run_config_of("steering")(
        terrain=TerrainConfig(arenas=1), held_out=HeldOutConfig(arenas=2)
    )
    write_text(tmp_path / "run" / "config.yaml", to_yaml(config))
    write_json(tmp_path / "run" / "provenance.json", {"format": 1})
    write_policy(tmp_path / "run" / "policy.npz", POLICY)
    return tmp_path / "run"


def test_a_run_is_exported_with_its_configuration_and_verdict(run, tmp_path, capsys):
    write_json(run / "evaluation" / "transitions.json", {"cells": [{"name": "rubble"}]})
    export(run, out=tmp_path / "out")
    assert "of JAX on" in capsys.readouterr().out
    record = json.loads((tmp_path / "out" / "export.json").read_text())
    assert "arenas: 2" in record["metadata"]["training_config"]
    assert record["metadata"]["success"] == [{"name": "rubble"}]
    assert load_policy(tmp_path / "out" / "policy.onnx").config == POLICY.config
    assert not (run / "policy.onnx").exists()


def test_a_policy_file_is_exported_into_a_folder_of_its_name(run, tmp_path, monkeypatch):
    """As `pretrained:NAME` is. How it was trained the file does not say, nor does the artifact."""
    few = np.tile(edge_cases(POLICY), (20, 1))  # instead of walking for them
    monkeypatch.setattr(recording, "record_observations", lambda *_: few)
    shutil.copy(run / "policy.npz", tmp_path / "mine.npz")
    monkeypatch.chdir(tmp_path)
    export(Path("mine.npz"))
    record = json.loads(Path("mine/export.json").read_text())
    assert (record["metadata"]["training_config"], record["metadata"]["success"]) == ("", None)
    assert load_policy("mine/policy.onnx").config == POLICY.config


def test_what_is_no_run_is_refused(tmp_path, run):
    for path, says in (
        (tmp_path / "none", "does not exist"),
        (tmp_path, "not a run folder"),
        (run / "config.yaml", "is no policy: a run folder or a policy.npz would do"),
    ):
        with pytest.raises(InputError, match=says):
            export(path)
    (run / "policy.npz").unlink()
    with pytest.raises(InputError, match=r"no policy\.npz"):
        export(run)


def test_a_run_of_another_version_is_refused(run):
    write_json(run / "provenance.json", {"format": 99, "jaxleas": "7.0"})
    with pytest.raises(InputError, match="format 99"):
        export(run)
