"""A point in the wind that learns to fly to a goal: a task that steps on the device."""

import jax
import jax.numpy as jnp

from jaxleas.envs.environment import Task
from jaxleas.envs.heads import Ball, Normal
from jaxleas.envs.mirror import Mirror
from jaxleas.envs.part import Part
from jaxleas.envs.signature import Signature
from jaxleas.envs.task_config import TaskConfig
from jaxleas.envs.task_values import Starts, StepResult

LEFT_RIGHT = Mirror.of_signs([1.0, -1.0])


class DriftConfig(TaskConfig):
    swept = ("fuel",)
    task: str = "tests.probes.drift:Drift"
    speed: float = 0.5
    wind: float = 0.1
    fuel: float = 0.1

    def signature(self) -> Signature:
        offset = Part("offset", (2,), deviation=2.0, mirror=LEFT_RIGHT)
        place = Part("place", (2,), deviation=2.0, mirror=LEFT_RIGHT, critic_only=True)
        return Signature((offset, place), (Normal("velocity", (Ball(self.speed, 2),), LEFT_RIGHT),))


class Drift(Task):
    Config = DriftConfig
    is_disturbed = True
    groups = ("near", "far")

    def make_world(self, seeds, examined):
        return {"goals": jax.random.uniform(jax.random.key(seeds[0]), (len(seeds), 2))}

    def draw_starts(self, world, key, count, examined=False):
        place_key, goal_key = jax.random.split(key)
        place = jax.random.uniform(place_key, (count, 2), minval=-2.0, maxval=2.0)
        goal = world["goals"][jax.random.randint(goal_key, (count,), 0, len(world["goals"]))]
        far = jnp.linalg.norm(place - goal, axis=-1) > 1.5
        state = {"place": place, "goal": goal, "step": jnp.zeros((count, 1))}
        return Starts(state, jnp.ones(count, dtype=bool), far.astype(jnp.int32))

    def draw_disturbances(self, key, shape):
        return self.config.wind * jax.random.normal(key, (*shape, 2))

    def advance(self, world, weights, state, action, disturbance):
        place = state["place"] + self.command(action) + disturbance
        before, distance = (
            jnp.linalg.norm(each - state["goal"], axis=-1) for each in (state["place"], place)
        )
        step = state["step"] + 1.0
        result = StepResult(
            reward=before - distance - weights["fuel"] * jnp.sum(action**2, axis=-1),
            terminated=distance > 5.0,
            truncated=step[..., 0] >= 20.0,
            reached=distance < 0.4,
            measures={"distance": distance},
        )
        return {"place": place, "goal": state["goal"], "step": step}, result

    def look(self, world, state):
        return {"offset": state["goal"] - state["place"], "place": state["place"]}
