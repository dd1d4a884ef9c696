"""What the configuration of a distillation does not state suits the robot, as in a training."""

import jax
import pytest
import yaml

from jaxleas.configuration.loading import load_config, to_yaml
from jaxleas.distillation import practice
from jaxleas.distillation.config import DistillationConfig
from jaxleas.distillation.loading import load_distillation
from jaxleas.robots import load_robot
from jaxleas.runs.checkpoints import Checkpoints
from jaxleas.runs.folder import RunFolder
from jaxleas.terrain import GeneratorConfig, scale_for, scaled
from jaxleas.training.run_config import load_run_config
from jaxleas.types import InputError

G1_ARENAS = scaled(GeneratorConfig(), scale_for(load_robot("g1")))
SOME = {"arenas": 2, "generator": {"rows": 3, "stairs": {"depth": [0.2, 0.3]}}}


def write(path, **stated):
    path.write_text(yaml.safe_dump(stated))
    return path


def begin_run(path, config):
    with RunFolder.create(path, to_yaml(config), ["train.py"]) as run:
        run.checkpoints.mkdir(exist_ok=True)
        (run.checkpoints / "step_000000000000.npz").touch()  # its content is not read


def test_terrain_of_practice_has_the_robots_size(tmp_path):
    file = write(tmp_path / "g1.yaml", run={"env": {"robot": "g1"}}, practice={"terrain": SOME})
    found = load_distillation(file)
    assert found.practice.terrain is not None
    generator = found.practice.terrain.generator
    assert generator.tile_size == G1_ARENAS.tile_size != GeneratorConfig().tile_size
    assert generator.stairs.climb == G1_ARENAS.stairs.climb
    assert (generator.rows, generator.stairs.depth) == (3, (0.2, 0.3))  # as stated
    assert found.run.env.height_low == pytest.approx(-1.4 * 0.7 / 0.95, abs=0.01)
    assert found.run.terrain.generator == G1_ARENAS
    again = tmp_path / "config.yaml"
    again.write_text(to_yaml(found))
    assert load_distillation(again) == load_config(DistillationConfig, again) == found


def test_it_is_the_robot_begun_with_that_practises(tmp_path):
    file = write(tmp_path / "p2.yaml", practice={"terrain": {"arenas": 2}})
    config = load_run_config(write(tmp_path / "g1_run.yaml", env={"robot": "g1"}))
    begin_run(tmp_path / "start", config)
    of_talos, of_g1 = load_distillation(file), load_distillation(file, tmp_path / "start")
    assert of_talos.practice.terrain is not None
    assert of_g1.practice.terrain is not None
    assert of_talos.practice.terrain.generator == GeneratorConfig()
    assert of_g1.practice.terrain.generator == G1_ARENAS
    assert of_g1.run == of_talos.run
    with pytest.raises(InputError, match="nowhere"):
        load_distillation(file, tmp_path / "nowhere")


def test_without_a_terrain_of_its_own_practice_has_none(tmp_path):
    base = write(tmp_path / "base.yaml", run={"env": {"robot": "g1"}}, practice={"terrain": SOME})
    assert load_distillation(base).practice.terrain is not None
    above = write(tmp_path / "above.yaml", extends="base.yaml", practice={"terrain": None})
    assert load_distillation(above).practice.terrain is None


def test_a_configuration_is_read_once_with_what_was_learned(tmp_path, monkeypatch):
    config = load_run_config(write(tmp_path / "run.yaml"))
    begin_run(tmp_path / "run", config)
    read = []

    def load(path):
        read.append(path)
        return load_run_config(path)

    monkeypatch.setattr(practice, "load_steering_run", load)
    monkeypatch.setattr(Checkpoints, "latest", lambda self, like, partial: (0, like, {}))
    found, learned = practice.read_run(tmp_path / "run")
    assert found == config
    assert jax.tree.leaves(learned)
    assert len(read) == 1
