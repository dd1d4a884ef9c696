"""Updates in stretches: from one examination to the next, or until a person asks to stop.

Every training advances like this, whatever it learns from: a single run, a population, a practice
with the exact planner in the loop. Only at the end of a stretch does the host wait for the devices.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import jax

from jaxleas.training.processes import any_process
from jaxleas.types import JaxleasError

Metrics = Mapping[str, Any]
# Updates that may be queued on the devices: in XLA:CPU, cores that share a program hang with more
# than about thirty queued runs of it.
MOST_AHEAD = 8
_FLAG = "finite/"


class NonFiniteError(JaxleasError):
    """A number became infinite or NaN; the run stops, the last good state is kept."""


class InterruptedRunError(JaxleasError):
    """The run was asked to stop and has saved everything done so far."""

    exit_code = 130  # what a shell reports for Ctrl-C


@dataclass(frozen=True)
class Schedule:
    """When the updates of a training end, and when they are looked at.

    Attributes:
        updates: number of updates of the whole training.
        every: number of updates between two examinations.
        one_by_one: whether each update is handed over when it is done: for those that take so long
            that waiting for the devices costs nothing.
    """

    updates: int
    every: int
    one_by_one: bool = False

    def is_due(self, done: int) -> bool:
        """Return whether an examination follows the update: every so often, and the last."""
        return done % self.every == 0 or done >= self.updates


@dataclass(frozen=True)
class Stretch:
    """Updates whose metrics have reached the host.

    Attributes:
        done: number of updates done since the training began.
        rows: number and metrics of each update of the stretch; empty where the training was stopped
            before one was done.
        due: whether an examination is due.
    """

    done: int
    rows: list[tuple[int, Metrics]]
    due: bool


def stretches(
    updates: Iterator[Metrics],
    schedule: Schedule,
    done: int,
    asked_to_stop: Callable[[], bool],
) -> Iterator[Stretch]:
    """Do the updates, and yield whenever an examination is due or all has to be saved.

    Asked to stop, it yields what was done and ends. Several processes decide that together, where
    they wait for each other anyway: at the examinations.

    Args:
        updates: metrics of each update, which is done when its metrics are drawn.
        schedule: number of updates, and interval of the examinations.
        done: number of updates that were done before.
        asked_to_stop: function that returns whether this process was asked to stop.
    """
    alone = jax.process_count() == 1
    pending: list[tuple[int, Metrics]] = []
    while done < schedule.updates:
        metrics = next(updates, None)
        if metrics is not None:
            done += 1
            pending.append((done, metrics))
        if len(pending) >= MOST_AHEAD:
            jax.block_until_ready(pending[-MOST_AHEAD][1])
        due = metrics is not None and schedule.is_due(done)
        stopped = metrics is None or (alone and asked_to_stop())
        if due or stopped or schedule.one_by_one:
            yield Stretch(done, jax.device_get(pending), due)
            pending = []
            if stopped or (due and any_process(asked_to_stop())):
                return


def numbers(metrics: Metrics) -> dict[str, float]:
    """Return what is logged of an update's metrics: all but the flags of finiteness."""
    return {name: float(value) for name, value in metrics.items() if not name.startswith(_FLAG)}


def non_finite(metrics: Metrics) -> str:
    """Return where an update made numbers that are not finite; empty: nowhere."""
    flags = {
        name.removeprefix(_FLAG): fine for name, fine in metrics.items() if name.startswith(_FLAG)
    }
    return ", ".join(name for name, fine in flags.items() if not fine)
