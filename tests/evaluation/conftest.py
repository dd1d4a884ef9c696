"""An environment, two methods that need no training, and a flat suite."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from flax import struct

from jaxleas.envs.steering.config import SteeringConfig
from jaxleas.envs.steering.env import SteeringEnv
from jaxleas.envs.steering.layout import layout_named
from jaxleas.evaluation.suites import Cell, Suite
from jaxleas.runs.folder import RunFolder
from jaxleas.terrain.scenarios import Scenario
from jaxleas.terrain.scene import Scene
from jaxleas.training.networks.mlp import Mlp, params_of
from jaxleas.training.policy import Policy, write_policy


@struct.dataclass
class StandStill:
    """A steering method that does not move."""

    def __call__(self, heights_in_root, motion, goal):
        del heights_in_root, goal
        return motion


@struct.dataclass
class Fly:
    """A steering method that jumps onto the goal in one step, whatever lies between."""

    def __call__(self, heights_in_root, motion, goal):
        del heights_in_root
        return motion.replace(position=goal)


@pytest.fixture(scope="session")
def env() -> SteeringEnv:
    return SteeringEnv(SteeringConfig())


def flat_scene(crossing: bool = True) -> Scenario:
    floor = np.array([[0.0, -2.0, 0.0], [6.0, -2.0, 0.0], [6.0, 2.0, 0.0], [0.0, 2.0, 0.0]])
    areas = ((1.1, 1.75, -0.7, 0.7), (0.5, 1.1, -0.7, 0.7))
    return Scenario("flat", Scene({"floor": floor}), areas, (4.5, 5.5, -0.5, 0.5), (), crossing)


@pytest.fixture
def flat_suite() -> Suite:
    scene = flat_scene()
    cells = tuple(Cell("flat", yaw, (scene,), 8) for yaw in (0.0, 180.0))
    return Suite("flat", seed=0, steps=400, cells=cells)


def random_policy(seed: int = 0) -> Policy:
    size = layout_named("thesis144").size
    first, second = jax.random.split(jax.random.key(seed))
    return Policy(
        mean=jnp.zeros(size),
        deviation=jnp.ones(size),
        params=params_of(
            [
                (0.1 * jax.random.normal(first, (size, 8)), jnp.zeros(8)),
                (0.1 * jax.random.normal(second, (8, 8)), jnp.zeros(8)),
            ]
        ),
        network=Mlp(size, (8,), 8, "relu"),
        signature=SteeringConfig().signature(),
        config=SteeringConfig(),
    )


@pytest.fixture
def run(tmp_path):
    """A run folder with a random policy, as a training would leave it."""
    path = tmp_path / "some_run"
    with RunFolder.create(path, "seed: 0  # <b>not markup</b>\n", ["train.py", "x.yaml"]):
        write_policy(path / "policy.npz", random_policy())
    return path
