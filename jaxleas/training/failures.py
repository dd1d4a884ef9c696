"""Where episodes failed lately, by the group of their start: so that failures are practised more.

The share of recent episodes of a group that failed is estimated by Laplace's rule of succession,
(failed + 1) / (ended + 2): a group of which nothing is known yet counts as failing half the time,
and one that never fails is never quite left out.
"""

from typing import Any

import jax.numpy as jnp
import numpy as np
from flax import struct
from jax import Array
from jaxtyping import Bool, Int

from jaxleas.training.config import PpoConfig

KEPT = 0.9
"""Share of the counts that is kept from one update to the next: about ten updates are recent."""


@struct.dataclass
class Failures:
    """Episodes by the group of their start, in arrays of JAX or, of a task on the host, NumPy.

    Attributes:
        group: number of the group in which each robot's present episode began [robots].
        ended: number of episodes of each group that ended, older ones counting less [groups].
        failed: number of those that failed [groups].
    """

    group: Any
    ended: Any
    failed: Any

    @property
    def rate(self) -> Any:
        """Share of the recent episodes of each group that failed [groups]."""
        return (self.failed + 1.0) / (self.ended + 2.0)


def no_failures(ppo: PpoConfig, group: Any, groups: int) -> Failures | None:
    """Return the state before any episode has ended; None where starts ignore failures.

    Args:
        ppo: configuration of PPO.
        group: number of the group of each robot's first start, of JAX or NumPy.
        groups: number of groups.
    """
    if not ppo.failure_starts:
        return None
    numpy = isinstance(group, np.ndarray)
    zeros = np.zeros(groups, np.float32) if numpy else jnp.zeros(groups)
    return Failures(group.astype(np.int32), zeros, zeros)


def counted(
    failures: Failures,
    began: Int[Array, "time robots"],
    over: Bool[Array, "time robots"],
    failed: Bool[Array, "time robots"],
    group: Int[Array, " robots"],
) -> Failures:
    """Return the counts after a roll-out on the device.

    Args:
        failures: counts before it.
        began: group in which the episode of each step began.
        over: whether the episode ended in the step.
        failed: whether the episode that ended failed.
        group: group in which each robot's episode began that is under way after the roll-out.
    """

    def count(old: Array, flag: Array) -> Array:
        now = jnp.zeros_like(old).at[began].add(flag.astype(old.dtype), mode="drop")
        return KEPT * old + now

    return Failures(group, count(failures.ended, over), count(failures.failed, failed))


def counted_on_host(
    failures: Failures,
    began: Int[np.ndarray, "time robots"],
    over: Bool[np.ndarray, "time robots"],
    failed: Bool[np.ndarray, "time robots"],
    group: Int[np.ndarray, " robots"],
) -> Failures:
    """Return the counts after a roll-out on the host; see `counted`."""

    def count(old: Any, flag: np.ndarray) -> np.ndarray:
        now = np.bincount(began[flag], minlength=len(old))
        return (KEPT * old + now).astype(np.float32)

    return Failures(group, count(failures.ended, over), count(failures.failed, failed))


def start_metrics(
    groups: tuple[str, ...], failures: Failures, group: Any, over: Any
) -> dict[str, Any]:
    """Return what is logged of the starts, from arrays of JAX or NumPy.

    Args:
        groups: names of the groups.
        failures: counts after the roll-out.
        group: group of the start that each robot would get after each step [time, robots].
        over: whether the robot got that start, because its episode ended.
    """
    total = jnp.maximum(over.sum(), 1)
    metrics = {}
    for number, name in enumerate(groups):
        metrics[f"walk/starts/{name}"] = (over & (group == number)).sum() / total
        metrics[f"walk/failure_rate/{name}"] = failures.rate[number]
    return metrics
