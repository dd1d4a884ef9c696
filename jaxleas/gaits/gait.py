"""A way of one robot, phase by phase, and rows of values that hold many robots."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal, TypeVar

import jax
import numpy as np

from jaxleas.dynamics import Transitions
from jaxleas.envs.gait_planning import (
    FEET,
    Command,
    GaitPlanningConfig,
    Phases,
    PlanningState,
    transitions_of,
)

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


def transitions_along(config: GaitPlanningConfig, phases: Phases, times: Any) -> Transitions:
    """Return the transitions from each phase of a way to the next.

    Args:
        config: configuration of the task.
        phases: phases [K + 1].
        times: t_E* and t_S of each transition [K, 2] [s].
    """
    before, after = taken(phases, slice(None, -1)), taken(phases, slice(1, None))
    return transitions_of(config, before, after, times)


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
