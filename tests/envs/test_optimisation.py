"""Tests compile with fewer optimisations than users do: what robots do and see is the same."""

import os
import subprocess
import sys

import jax
import numpy as np
import pytest

from jaxleas.envs.steering import Steering, SteeringConfig

from .worlds import height_map, world_of

ROBOTS, STEPS = 64, 20


def cliff(x, y):
    return 0.6 * (x > 1.0) + 0.02 * np.sin(3.0 * y)


def walked() -> dict[str, np.ndarray]:
    """Return what robots that walk straight on meet in every step, and what they see at the end."""
    steering = Steering(SteeringConfig())
    world = world_of(height_map(cliff))
    weights = steering.weights(dict.fromkeys(SteeringConfig.swept, 1.0), 0.5)

    @jax.jit
    def walk(key):
        start_key, action_key = jax.random.split(key)
        state = steering.draw_starts(world, start_key, ROBOTS).state
        action = jax.random.uniform(action_key, (ROBOTS, 4), minval=-1.0)

        def step(state, _):
            state, result = steering.advance(world, weights, state, action)
            return state, (result.reward, result.terminated)

        state, (reward, failed) = jax.lax.scan(step, state, length=STEPS)
        return {"reward": reward, "failed": failed, "seen": steering.look(world, state)}

    return {name: np.asarray(value) for name, value in walk(jax.random.key(0)).items()}


@pytest.mark.slow
def test_robots_meet_and_see_the_same_fully_optimised(tmp_path):
    """But for the few that stand on the very edge of what is valid."""
    program = "import sys, numpy; from tests.envs.test_optimisation import walked"
    subprocess.run(
        [sys.executable, "-c", f"{program}; numpy.savez(sys.argv[1], **walked())", tmp_path / "o"],
        env=os.environ | {"XLA_FLAGS": ""},
        check=True,
    )
    here = walked()
    assert 0.05 < here["failed"].mean() < 0.95
    with np.load(tmp_path / "o.npz") as optimised:
        for name, value in here.items():
            away = ~np.isclose(value, optimised[name], atol=1e-4)
            assert away.mean() < 0.005, name
