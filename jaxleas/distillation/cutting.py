"""Episodes cut where the exact planner failed (T 4.2.2, fig. 4.6), laid end to end into batches."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import jax.numpy as jnp
import numpy as np
from jax import Array
from jaxtyping import Float, Int

from jaxleas.distillation.episodes import Episodes
from jaxleas.envs import NormalDistribution
from jaxleas.training import Experience
from jaxleas.types import Verdict

_KEPT = ("observation", "raw_action", "location", "deviation", "reward")
Steps = dict[str, np.ndarray]
"""Consecutive steps, [M, ...], to learn from."""


def kept_steps(episodes: Episodes, verdicts: Sequence[Verdict]) -> Int[np.ndarray, " N"]:
    """Return how many steps of each episode are learned from.

    All of them where the planner succeeded. Otherwise, those up to and including the step that
    leaves the last configuration it reached, which becomes the one that fails; zero where it did
    not even reach the first, or where its time ran out first.
    """
    kept = [
        steps if verdict.success else min(verdict.last_index + 1, steps) if verdict.decided else 0
        for steps, verdict in zip(episodes.steps.tolist(), verdicts, strict=True)
    ]
    return np.array(kept, np.int64)


def cut(episodes: Episodes, verdicts: Sequence[Verdict]) -> Steps:
    """Return the accepted steps of all episodes, end to end.

    A failed tail is cut off; the step before it terminates the episode and is charged what an
    invalid configuration costs, exactly as if a condition of the environment had failed there.

    Args:
        episodes: episodes as walked.
        verdicts: verdict of the exact planner on each episode.
    """
    kept = kept_steps(episodes, verdicts)
    failed = np.array([each.decided and not each.success for each in verdicts])
    time = np.arange(episodes.reward.shape[1])[None]
    last = time == kept[:, None] - 1
    by_planner = last & failed[:, None]
    terminated = (episodes.terminated & ~failed[:, None]) | by_planner
    truncated = last & ~terminated
    # An invalid configuration has paid already; only a valid one still has its step's reward.
    cost = episodes.failure_cost * (by_planner & ~episodes.terminated)
    arrays = {name: getattr(episodes, name) for name in _KEPT}
    arrays |= {
        "reward": episodes.reward - cost.astype(episodes.reward.dtype),
        "terminated": terminated,
        "truncated": truncated,
        "by_planner": by_planner,
        "reached": episodes.reached,
        "update": np.full(episodes.reward.shape, episodes.update, np.int32),
    }
    there = time < kept[:, None]
    return {name: array[there] for name, array in arrays.items()}


@dataclass
class Stream:
    """Accepted steps waiting to be learned from, in the order they were walked.

    Attributes:
        environments: number of rows in a batch.
        unroll: number of steps per row.
    """

    environments: int
    unroll: int
    _parts: list[Steps] = field(default_factory=list)

    def __len__(self) -> int:
        """Return the number of steps that wait."""
        return sum(len(part["reward"]) for part in self._parts)

    def add(self, steps: Steps) -> None:
        """Append accepted steps."""
        if len(steps["reward"]):
            self._parts.append(steps)

    def batch(self) -> Steps | None:
        """Take out a batch and the one step after it, or None while there are too few.

        That step stays: its observation is what the last row's value is bootstrapped from.
        """
        size = self.environments * self.unroll
        if len(self) <= size:
            return None
        names = self._parts[0]
        whole = {name: np.concatenate([part[name] for part in self._parts]) for name in names}
        self._parts = [{name: array[size:] for name, array in whole.items()}]
        return {name: array[: size + 1] for name, array in whole.items()}


def to_experience(
    steps: Steps, environments: int, unroll: int
) -> tuple[Experience, Float[Array, "environments size"]]:
    """Return a batch in the form that PPO learns from, and the observation after its last step.

    Each row is a stretch of the stream. It may run over the end of one episode into the next, as
    the rows of the ordinary training do, since an end is marked as one.
    """
    size = environments * unroll

    def rows(name: str) -> jnp.ndarray:
        array = steps[name][:size]
        return jnp.asarray(array.reshape(environments, unroll, *array.shape[1:]).swapaxes(0, 1))

    after = steps["observation"][unroll::unroll][:environments]
    experience = Experience(
        observation=rows("observation"),
        raw_action=rows("raw_action"),
        distributions=(NormalDistribution(rows("location"), rows("deviation")),),
        reward=rows("reward"),
        terminated=rows("terminated").astype(jnp.float32),
        truncated=rows("truncated").astype(jnp.float32),
    )
    return experience, jnp.asarray(after)
