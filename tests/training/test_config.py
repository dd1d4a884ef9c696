"""Every shipped configuration loads; what it cannot mean is refused with the field's name."""

import pytest

from jaxleas.configuration.loading import to_yaml
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
