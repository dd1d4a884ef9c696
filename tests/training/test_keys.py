"""Every random key is used once: JAX follows them through a training's compiled programs."""

import jax
import numpy as np
import pytest

from jaxleas.terrain import HeightMap, write_height_map
from jaxleas.training.run_config import make_task
from jaxleas.training.trainer import Trainer

from .runs import TINY, SteeringRun

pytestmark = pytest.mark.usefixtures("brax_ranks")


@pytest.mark.slow
def test_starts_of_every_kind_and_an_update_use_each_key_once(tmp_path):
    level = np.zeros((200, 200), np.float32)
    write_height_map(tmp_path / "yard.npz", HeightMap(level, 0.04, (0.0, 0.0)))
    own = {"files": [str(tmp_path / "yard.npz")], "files_share": 0.3}
    stated = TINY | {
        "terrain": TINY["terrain"] | own,
        "env": TINY.get("env", {}) | {"wander_share": 0.2},
        "ppo": TINY["ppo"] | {"steps": 64 * 10},
    }
    config = SteeringRun.model_validate(stated)
    trainer = Trainer(config, make_task(config))
    with jax.debug_key_reuse(True):
        state = trainer.fresh_state()
        state, _ = trainer.train_step(trainer.world, state)
    assert int(state.update) == 1


def test_a_key_used_twice_is_found():
    def twice(key):
        return jax.random.uniform(key) + jax.random.normal(key)

    with jax.debug_key_reuse(True), pytest.raises(jax.errors.KeyReuseError):
        jax.jit(twice)(jax.random.key(0))
