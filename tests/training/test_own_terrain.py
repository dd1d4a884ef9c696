"""Training on terrain files: they train, they never judge, and a resumed run finds them again."""

import importlib
import sys

import jax
import numpy as np
import pytest
import yaml

from benchmarks.tiny import tiny_training
from jaxleas.configuration.loading import to_yaml
from jaxleas.runs.folder import RunFolder
from jaxleas.terrain import write_height_map
from jaxleas.terrain.height_map import HeightMap
from jaxleas.training.loop import train
from jaxleas.training.run_config import load_run_config, make_task, pinned
from jaxleas.training.trainer import Trainer
from jaxleas.training.worlds import held_out_world, training_world
from jaxleas.types import InputError

from .runs import ROOT, SteeringRun
from .test_loop import assert_same_run


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A working folder with terrain files, none of which has cells of the default size but two."""
    level = np.zeros((200, 200), np.float32)
    write_height_map(tmp_path / "yard.npz", HeightMap(level, 0.04, (0.0, 0.0)))
    write_height_map(tmp_path / "post.npz", HeightMap(level[:20, :20], 0.04, (0.0, 0.0)))
    write_height_map(tmp_path / "coarse.npz", HeightMap(level, 0.1, (0.0, 0.0)))
    corners = [(0, 0), (4, 0), (4, 4), (0, 4)]
    lines = [f"v {1000 * x} 0 {1000 * y}" for x, y in corners]  # millimetres, y up
    (tmp_path / "hall.obj").write_text("\n".join([*lines, "f 1 4 3 2", ""]))
    monkeypatch.chdir(tmp_path)
    return tmp_path


def config_with(folder, updates=4, ppo=None, **terrain) -> SteeringRun:
    stated = tiny_training(updates)
    stated["terrain"] |= terrain
    stated["ppo"] |= ppo or {}
    (folder / "run.yaml").write_text(yaml.safe_dump(stated))
    return load_run_config(folder / "run.yaml")


def test_files_join_the_atlas_and_never_the_examination(folder):
    mesh = {"file": "hall.obj", "up": "y", "scale": 0.001}
    config = config_with(folder, files=["yard.npz", mesh], files_share=0.4)
    world = training_world(config, make_task(config))
    assert len(world.atlas) == 2 + 2
    assert world.own is not None
    np.testing.assert_array_equal(world.own.map_index, [2, 3])
    assert float(world.own.share) == np.float32(0.4)
    held_out = held_out_world(config, make_task(config))
    assert held_out.own is None
    plain = held_out_world(config_with(folder), make_task(config_with(folder)))
    for left, right in zip(jax.tree.leaves(held_out), jax.tree.leaves(plain), strict=True):
        np.testing.assert_array_equal(left, right)


@pytest.mark.parametrize(
    ("terrain", "said"),
    [
        ({"files_share": 0.5}, r"terrain: files_share is 0\.5, but no files are given"),
        ({"files": ["yard.npz"]}, r"terrain: files are given, but files_share is 0"),
        ({"files": ["yard.npz"], "files_share": 1.5}, r"terrain\.files_share is 1\.5"),
        ({"files": "yard.npz", "files_share": 0.5}, r"terrain\.files is 'yard\.npz'"),
        ({"files": [{"file": "a.obj", "up": "w"}], "files_share": 0.5}, "up"),
    ],
)
def test_what_a_configuration_cannot_mean_is_refused_when_it_is_read(folder, terrain, said):
    with pytest.raises(InputError, match=said):
        config_with(folder, **terrain)


@pytest.mark.parametrize(
    ("file", "said"),
    [
        ("gone.npz", r"terrain\.files: gone\.npz does not exist"),
        ("run.yaml", r"terrain\.files: \S*run\.yaml has 0 lists; a terrain of boxes has one"),
        ("coarse.npz", r"terrain\.files: \S*coarse\.npz is a map of 0\.1 m cells"),
        ("post.npz", r"terrain\.files: \S*post\.npz: talos finds no two places to stand at"),
        ({"file": "wide.png"}, r"terrain\.files: \S*wide\.png is an image: say its"),
    ],
)
def test_a_file_that_cannot_be_trained_on_is_refused_by_file_and_key(folder, file, said):
    (folder / "wide.png").write_bytes(b"not read")
    config = config_with(folder, files=[file], files_share=1.0)
    with pytest.raises(InputError, match=said):
        training_world(config, make_task(config))
    # And before a run folder is made.
    train_py = importlib.import_module("train")
    with pytest.raises(InputError, match=said):
        train_py.main(["run.yaml", "--run-dir", "run"])
    assert not (folder / "run").exists()


def test_a_resolved_configuration_finds_its_files_and_notices_a_change(folder, monkeypatch):
    config = config_with(folder, files=["yard.npz"], files_share=1.0)
    (folder / "elsewhere").mkdir()
    (folder / "elsewhere" / "config.yaml").write_text(to_yaml(pinned(config)))
    monkeypatch.chdir(folder / "elsewhere")
    again = load_run_config("config.yaml")
    assert again == pinned(again) != config
    assert training_world(again, make_task(again)).own is not None
    level = np.full((200, 200), 0.01, np.float32)
    write_height_map(folder / "yard.npz", HeightMap(level, 0.04, (0.0, 0.0)))
    with pytest.raises(InputError, match=r"terrain\.files: /.*yard\.npz has changed since"):
        training_world(again, make_task(again))


@pytest.mark.usefixtures("brax_ranks")
@pytest.mark.slow
def test_a_resumed_run_on_files_equals_one_left_in_peace(folder):
    config = pinned(config_with(folder, files=["yard.npz"], files_share=0.5))

    class PowerCutError(Exception):
        pass

    def cut() -> None:
        raise PowerCutError

    with RunFolder.create(folder / "whole", to_yaml(config), ["test"]) as run:
        train(config, run)
    with (
        RunFolder.create(folder / "cut", to_yaml(config), ["test"]) as run,
        pytest.raises(PowerCutError),
    ):
        train(config, run, on_examined=cut)
    with RunFolder.open(folder / "cut", writing=True) as run:
        train(load_run_config(run.config), run)
    assert_same_run(folder / "whole", folder / "cut")


@pytest.mark.usefixtures("brax_ranks")
@pytest.mark.slow
def test_a_policy_learns_on_a_file_alone(folder):
    robots, updates = 256, 40
    ppo = {
        "environments": robots,
        "unroll": 20,
        "steps": robots * 20 * updates,
        "minibatches": 8,
        "epochs": 4,
        "learning_rate": 3e-3,
        "final_learning_rate": 1e-3,
        "final_failure": 0.0,
        "discount": 0.95,
        "candidates": 256,
    }
    config = config_with(folder, ppo=ppo, files=["yard.npz"], files_share=1.0)
    trainer = Trainer(config, make_task(config))
    state, rewards = trainer.fresh_state(), []
    for _ in range(updates):
        state, metrics = trainer.train_step(trainer.world, state)
        rewards.append(float(metrics["walk/reward"]))
    # Measured: from -0.21 to 0.41 a step.
    assert np.mean(rewards[-5:]) > np.mean(rewards[:5]) + 0.3
    assert set(np.unique(np.asarray(state.episode.plan.map_index))) == {2}


OWN = """
import numpy as np


class Level:
    def __init__(self, robot, candidates):
        self.points_in_root = np.array([[0.5, 0.0]])

    def __call__(self, heights_in_root, motion):
        return heights_in_root[..., 0] + 2.0
"""


def test_code_that_a_file_names_is_run_with_permission_only(folder, monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT))
    monkeypatch.setattr(sys, "path", list(sys.path))
    (folder / "only_here_level.py").write_text(OWN)
    stated = tiny_training(2) | {"env": {"conditions": ["collision", "only_here_level:Level"]}}
    (folder / "run.yaml").write_text(yaml.safe_dump(stated))
    train_py = importlib.import_module("train")
    with pytest.raises(InputError, match="--allow only_here_level:Level"):
        train_py.main(["run.yaml", "--run-dir", "run"])
    assert not (folder / "run").exists()
    config = load_run_config("run.yaml")
    with RunFolder.create("run", to_yaml(config), ["test"]):
        pass
    with pytest.raises(InputError, match="--allow only_here_level:Level"):
        train_py.main(["--resume", "run"])
    assert "only_here_level" not in sys.modules
    trainer = Trainer(config, make_task(config, ["only_here_level:Level"]))
    assert "only_here_level" in sys.modules
    np.testing.assert_array_equal(trainer.task.env.points_in_root[-1], [0.5, 0.0])
    sys.modules.pop("only_here_level")
