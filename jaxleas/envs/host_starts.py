"""Fresh starts for episodes that are over, in NumPy, for tasks that step on the host."""

from dataclasses import dataclass
from typing import Any

import jax
import numpy as np
from jaxtyping import Bool, Float, Int

from jaxleas.envs.task_values import Starts
from jaxleas.types import InputError


@dataclass(frozen=True)
class HostPool:
    """Valid candidates for the next starts.

    Attributes:
        state: state of each valid candidate.
        group: number of the group of each valid candidate.
        drawn: number of candidates that were drawn, valid or not.
    """

    state: Any
    group: Int[np.ndarray, " valid"]
    drawn: int

    def __len__(self) -> int:
        """Return the number of valid candidates."""
        return len(self.group)

    @classmethod
    def of(cls, starts: Starts) -> "HostPool":
        """Return a pool of the valid starts.

        Raises:
            InputError: no start is valid: no episode could begin.
        """
        valid = np.flatnonzero(np.asarray(starts.valid))
        if not len(valid):
            raise InputError(
                f"the task drew {len(starts.valid)} starts, none of which is valid: no episode can"
                " begin"
            )
        state, group = jax.tree.map(
            lambda leaf: np.asarray(leaf)[valid], (starts.state, starts.group)
        )
        return cls(state, group, len(starts.valid))

    def draw_picks(
        self, generator: np.random.Generator, shape: tuple[int, ...]
    ) -> Int[np.ndarray, "*shape"]:
        """Return indices of candidates, drawn uniformly."""
        return generator.integers(len(self), size=shape)

    def draw_failing_picks(
        self,
        generator: np.random.Generator,
        shape: tuple[int, ...],
        rate: Float[np.ndarray, " groups"],
        share: float,
    ) -> Int[np.ndarray, "*shape"]:
        """Return indices of candidates, more often of groups that fail often.

        Args:
            generator: generator of random numbers.
            shape: shape of the indices.
            rate: share of each group's episodes that failed, above 0.
            share: share of the indices that is drawn in proportion to `rate`; the rest is drawn
                evenly.
        """
        failing = rate[self.group].astype(float)
        chance = (1.0 - share) / len(self) + share * failing / failing.sum()
        return generator.choice(len(self), size=shape, p=chance / chance.sum())

    def take(self, pick: Int[np.ndarray, " count"]) -> tuple[Any, Int[np.ndarray, " count"]]:
        """Return the states and groups of some candidates."""
        return jax.tree.map(lambda leaf: leaf[pick], (self.state, self.group))

    def restart_where(
        self, done: Bool[np.ndarray, " batch"], state: Any, pick: Int[np.ndarray, " batch"]
    ) -> Any:
        """Give a fresh start to the robots whose episode is over; leave the others alone.

        Args:
            done: whether each episode is over.
            state: state of the episodes.
            pick: index of the candidate that each robot would get.
        """
        over = np.flatnonzero(done)
        if not len(over):
            return state

        def renewed(old: np.ndarray, fresh: np.ndarray) -> np.ndarray:
            new = np.array(old)
            new[over] = fresh[pick[over]]
            return new

        return jax.tree.map(renewed, state, self.state)


def as_numpy(state: Any) -> Any:
    """Return a state in NumPy's arrays: what computed it may have used JAX."""
    return jax.tree.map(np.asarray, state)
