"""A task whose answers are known: robots wait, are paid every step, and may end after each."""

import jax
import jax.numpy as jnp

from jaxleas.envs.environment import Task
from jaxleas.envs.heads import Ball, Normal
from jaxleas.envs.part import Part
from jaxleas.envs.signature import Signature
from jaxleas.envs.task_config import TaskConfig, WorldsConfig
from jaxleas.envs.task_values import Starts, StepResult
from jaxleas.training.config import RunConfig

LOWEST, HIGHEST, SAME = -1.4, -0.6, 3.0  # what the robots see: a draw per episode, and a constant


class WaitingConfig(TaskConfig):
    """How robots are paid, and whether a step ends their episode."""

    swept = ("pay", "final_pay")
    task: str = "tests.training.waiting:Waiting"
    pay: float = 1.0
    final_pay: float = 1.0
    ends: bool = False

    def signature(self) -> Signature:
        return Signature(
            (Part("level", (1,)), Part("same", (1,))), (Normal("push", (Ball(1, 1),)),)
        )


class Waiting(Task):
    """Robots that wait."""

    Config = WaitingConfig

    def make_world(self, seeds, examined):
        return jnp.zeros(())

    def draw_starts(self, world, key, count, examined=False):
        level = jax.random.uniform(key, (count, 1), minval=LOWEST, maxval=HIGHEST)
        return Starts(level, jnp.ones(count, bool), jnp.zeros(count, jnp.int32))

    def weights(self, numbers, progress):
        return numbers["pay"] + (numbers["final_pay"] - numbers["pay"]) * progress

    def advance(self, world, weights, state, action, disturbance):
        robots = len(state)
        never = jnp.zeros(robots, bool)
        ends = jnp.full(robots, self.config.ends)
        pay = jnp.full(robots, weights)
        return state, StepResult(pay, terminated=ends, truncated=never, reached=never)

    def look(self, world, state):
        return {"level": state, "same": jnp.full_like(state, SAME)}


WaitingRun = RunConfig[WaitingConfig, WorldsConfig]
