"""A way of one robot, phase by phase, and rows of values that hold many robots."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal, TypeVar

import jax
import numpy as np

from jaxleas.envs.gait_planning import FEET, Command, PlanningState

Rows = TypeVar("Rows")
Ending = Literal["reached", "budget", "no move", "refused"]
"""The goal is reached; the plan would be too long; no state has a move; a policy's next transition
is refused."""


@dataclass(frozen=True, eq=False)
class Gait:
    """A way of one robot, phase by phase.

    Attributes:
        ending: how it ended.
        states: states at the beginning of each phase [K + 1].
        commands: commands from each to the next [K].
    """

    ending: Ending
    states: PlanningState
    commands: Command


def gait_of(ending: Ending, states: Sequence[PlanningState], commands: Sequence[Command]) -> Gait:
    """Return the way through some states, one row each, by commands, one row each."""
    return Gait(ending, _joined(states), _joined([no_commands(), *commands]))


def no_commands() -> Command:
    """Return commands without rows."""
    pair = np.zeros((0, 2))
    return Command(
        np.zeros(0), pair, pair, np.zeros((0, len(FEET), 2)), pair, np.zeros(0, np.int64)
    )


def taken(rows: Rows, places: Any) -> Rows:
    """Return some rows of every array of a value."""
    return jax.tree.map(lambda leaf: leaf[places], rows)


def _joined(parts: Sequence[Any]) -> Any:
    return jax.tree.map(lambda *leaves: np.concatenate(leaves), *parts)
