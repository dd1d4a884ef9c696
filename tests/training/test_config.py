"""Every shipped configuration loads; what it cannot mean is refused with the field's name."""

import pytest

from jaxleas.configuration.loading import to_yaml
from jaxleas.terrain import GeneratorConfig
from jaxleas.training.run_config import load_run_config, make_task
from jaxleas.training.worlds import training_world
from jaxleas.types import InputError

from .runs import ROOT, tiny

# Those of a distillation are read by tests/distillation.
CONFIGS = sorted(set((ROOT / "configs").glob("*.yaml")) - set((ROOT / "configs").glob("leas_p2_*")))


@pytest.mark.parametrize("path", CONFIGS, ids=lambda path: path.stem)
def test_it_loads_and_its_resolved_form_means_the_same(path, tmp_path):
    config = load_run_config(path)
    (tmp_path / "resolved.yaml").write_text(to_yaml(config))
    assert load_run_config(tmp_path / "resolved.yaml") == config


@pytest.mark.parametrize(
    ("overrides", "said"),
    [
        (["--ppo.minibatches", "7"], "minibatches = 7 does not divide environments"),
        (["--ppo.steps", "-1"], "ppo.steps"),
        (["--ppo.discount", "1.5"], "ppo.discount"),
        (["--ppo.learning_rte", "1e-3"], "perhaps you meant --ppo.learning_rate"),
        (["--ppo.clip", "wide"], "ppo.clip"),
        (["--env.observation", "thesis81"], "env.observation"),
        (["--terrain.first_seed", "1000000"], "terrain.first_seed"),
        (["--network.hidden", "[0]"], "network.hidden"),
        (["--ppo.steps", ".nan"], "ppo.steps"),
        (["--env.goal_steps", "[800, 200]"], "goal_steps"),
        (["--env.height_low", "0.5"], "height_low"),
    ],
)
def test_what_cannot_be_is_refused_by_name(overrides, said):
    with pytest.raises(InputError) as refusal:
        load_run_config(ROOT / "configs" / "leas_p1.yaml", overrides)
    assert said in str(refusal.value)


def test_training_terrain_never_reaches_into_the_seeds_of_evaluation():
    config = tiny()
    terrain = config.terrain.model_copy(update={"first_seed": 900_000})
    with pytest.raises(InputError, match="kept for evaluation"):
        training_world(config.model_copy(update={"terrain": terrain}), make_task(config))


def test_what_no_one_states_suits_the_robot(tmp_path):
    (tmp_path / "g1.yaml").write_text("env: {robot: g1}\nterrain: {arenas: 3}\n")
    config = load_run_config(
        tmp_path / "g1.yaml", ["--terrain.generator.stairs.climb", "[0.3, 0.4]"]
    )
    generator = config.terrain.generator
    assert config.terrain.arenas == 3
    assert (config.env.height_low, config.env.height_high) == (-1.032, -0.147)
    assert (generator.tile_size, generator.stairs.riser_max) == (1.474, 0.147)
    assert generator.stairs.climb == (0.3, 0.4)  # as stated
    chosen = load_run_config(ROOT / "configs" / "leas_p1.yaml", ["--env.robot=g1"])
    assert chosen.terrain.generator.tile_size == 1.474
    plain = load_run_config(ROOT / "configs" / "leas_p1.yaml")
    assert plain.terrain.generator == GeneratorConfig()


def test_a_run_folder_keeps_the_numbers_that_it_was_made_with(tmp_path):
    stated = load_run_config(ROOT / "configs" / "leas_p1.yaml")
    env = stated.env.model_copy(update={"robot": "g1"})
    before = stated.model_copy(update={"env": env})  # as an earlier version wrote it
    (tmp_path / "config.yaml").write_text(to_yaml(before))
    assert load_run_config(tmp_path / "config.yaml") == before


def test_a_run_of_a_robot_that_is_not_here_can_be_read(tmp_path):
    (tmp_path / "run.yaml").write_text("env: {robot: robots/lent.json, height_low: -0.9}\n")
    assert load_run_config(tmp_path / "run.yaml").env.height_low == -0.9
