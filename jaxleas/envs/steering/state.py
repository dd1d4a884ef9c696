"""The evolving values of the steering environment."""

from typing import Any

import jax.numpy as jnp
from flax import struct
from jax import Array
from jaxtyping import Float, Int

from jaxleas.envs import StepResult
from jaxleas.geometry import wrap_angle
from jaxleas.terrain import Lag
from jaxleas.types import RootMotion

GOALS = 4  # goals drawn ahead for an episode: more than its steps can use up


@struct.dataclass
class Route:
    """The route of an episode: its terrain and the goals that it has, one after another.

    It is drawn whole at the start of an episode, so that a step needs no randomness of its own.

    Attributes:
        map_index: index of the terrain in the atlas.
        goals: positions of the goals in the world [m]: the first across a link, the others
            anywhere in the arena.
        goal_steps: number of steps after which each goal is replaced by the next.
    """

    map_index: Int[Array, "*batch"]
    goals: Float[Array, "*batch goals 2"]
    goal_steps: Int[Array, "*batch goals"]


Plan = Route
"""The former name of `Route`."""


@struct.dataclass
class Past:
    """Where the root was in the last steps, the oldest first.

    Attributes:
        position: position of the root [m].
        yaw: heading [rad].
    """

    position: Float[Array, "*batch steps 3"]
    yaw: Float[Array, "*batch steps"]

    @classmethod
    def of(cls, motion: RootMotion, steps: int) -> "Past":
        """Return the past of a root that has stood where it is."""
        return cls(
            jnp.repeat(motion.position[..., None, :], steps, axis=-2),
            jnp.repeat(motion.yaw[..., None], steps, axis=-1),
        )

    def then(self, motion: RootMotion) -> "Past":
        """Return the past one step later, `motion` being that before the step."""
        return Past(
            jnp.concatenate([self.position[..., 1:, :], motion.position[..., None, :]], axis=-2),
            jnp.concatenate([self.yaw[..., 1:], motion.yaw[..., None]], axis=-1),
        )

    def lag(self, motion: RootMotion) -> Lag:
        """Return where the root was at the oldest step, from where it is now."""
        return lag_between(motion.position, motion.yaw, self.position[..., 0, :], self.yaw[..., 0])


def lag_between(position: Array, yaw: Array, position_then: Array, yaw_then: Array) -> Lag:
    """Return where roots were [m, rad], from where they are now."""
    return Lag(position_then - position, wrap_angle(yaw_then - yaw))


@struct.dataclass
class SteeringState:
    """One episode in progress.

    Attributes:
        motion: motion of the root.
        plan: route of the episode, under the name that it has in checkpoints.
        goal_index: index of the current goal.
        goal_age: number of steps since that goal was set.
        step: number of steps since the episode began.
        memory: memory of the environment's foresight; empty without one.
        past: where the root was in the last steps, the oldest first, where maps are late; else
            empty.
    """

    motion: RootMotion
    plan: Route
    goal_index: Int[Array, "*batch"]
    goal_age: Int[Array, "*batch"]
    step: Int[Array, "*batch"]
    memory: Any = ()
    past: Any = ()


@struct.dataclass
class SteeringResult(StepResult):
    """The result of a step, besides the next state.

    Attributes:
        margin: margin of the condition [m], positive where satisfied.
    """

    margin: Float[Array, "*batch"]


@struct.dataclass
class SeenResult(SteeringResult):
    """The result of a step, and the observation after it.

    Attributes:
        observation: observation of the state reached [physical units], also at the end of an
            episode.
    """

    observation: Float[Array, "*batch size"]
