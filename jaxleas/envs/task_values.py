"""The values that a task's methods return: starts, step results, the measure of success."""

from dataclasses import dataclass
from typing import Any

import jax
import jax.numpy as jnp
from flax import struct
from jax import Array
from jaxtyping import Bool, Float, Int


@struct.dataclass
class Starts:
    """Candidates for the first states of episodes.

    Attributes:
        state: state of each candidate, a pytree of arrays [candidates, ...].
        valid: whether an episode may begin at each candidate.
        group: number of each candidate's group, an index of `Task.groups`.
    """

    state: Any
    valid: Bool[Array, " candidates"]
    group: Int[Array, " candidates"]


@struct.dataclass
class StepResult:
    """The result of a step, besides the next state.

    Attributes:
        reward: reward for the step.
        terminated: whether the episode failed: it ends, and nothing follows.
        truncated: whether the episode was cut: its future has a value that was not seen.
        reached: whether the goal sought during the step was reached.
        measures: further numbers by name, whose means are logged as `walk/NAME`.
    """

    reward: Float[Array, "*batch"]
    terminated: Bool[Array, "*batch"]
    truncated: Bool[Array, "*batch"]
    reached: Bool[Array, "*batch"]
    measures: dict[str, Float[Array, "*batch"]] = struct.field(default_factory=dict, kw_only=True)


@dataclass(frozen=True)
class Examination:
    """The measure of success during training, on worlds that are never trained on.

    Attributes:
        starts: number of episodes; each is walked by the deterministic policy until it reaches its
            goal, fails, or runs out of time.
        steps: largest number of steps of each episode.
        cells: groups of starts whose success is reported separately, besides that of all.
        stops: groups of starts in which staying valid is success, whether the goal is reached or
            not; they do not count in the share that reached.
        by_worst: whether the policy that is kept is the one that does best where it does worst, of
            `cells` and `stops`, instead of the one that reaches most goals.
    """

    starts: int
    steps: int
    cells: tuple[str, ...] = ()
    stops: tuple[str, ...] = ()
    by_worst: bool = False


def select(flag: Bool[Array, " robots"], chosen: Any, other: Any) -> Any:
    """Return, robot by robot, `chosen` where `flag` is true and `other` elsewhere."""

    def pick(left: Array, right: Array) -> Array:
        return jnp.where(flag.reshape(flag.shape + (1,) * (left.ndim - flag.ndim)), left, right)

    return jax.tree.map(pick, chosen, other)
