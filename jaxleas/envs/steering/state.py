"""The values of the steering environment that evolve."""

from typing import Any

from flax import struct
from jax import Array
from jaxtyping import Float, Int

from jaxleas.envs.environment import StepResult
from jaxleas.types import RootMotion

GOALS = 4  # goals drawn ahead for an episode: more than its steps can use up


@struct.dataclass
class Plan:
    """What an episode asks: where the robot is and which goals it is given, one after another.

    Drawn whole at the start of an episode, so that a step needs no randomness of its own.

    Attributes:
        map_index: terrain of the atlas.
        goals: in the world [m]: the first across a link, the others anywhere in the arena.
        goal_steps: after how many steps each goal is replaced by the next.
    """

    map_index: Int[Array, "*batch"]
    goals: Float[Array, "*batch goals 2"]
    goal_steps: Int[Array, "*batch goals"]


@struct.dataclass
class SteeringState:
    """One episode in progress.

    Attributes:
        motion: of the root.
        plan: of the episode.
        goal_index: which goal is sought now.
        goal_age: steps since that goal was given.
        step: steps since the episode began.
        memory: what the environment's foresight remembers; empty without one.
    """

    motion: RootMotion
    plan: Plan
    goal_index: Int[Array, "*batch"]
    goal_age: Int[Array, "*batch"]
    step: Int[Array, "*batch"]
    memory: Any = ()


@struct.dataclass
class SteeringResult(StepResult):
    """What a step tells, besides the next state.

    Attributes:
        margin: margin of the condition [m], positive where satisfied.
    """

    margin: Float[Array, "*batch"]


@struct.dataclass
class SeenResult(SteeringResult):
    """What a step tells, and what is seen after it.

    Attributes:
        observation: of the state reached [physical units]; the last one of an episode, too.
    """

    observation: Float[Array, "*batch size"]
