"""The runs of a collection: movements, speeds, and how commands change (thesis, section 4.1.1)."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from jaxleas.types import MOVEMENTS, ControllerIdentity, InputError

FRACTIONS = tuple(round(0.1 * each, 1) for each in range(1, 11))
"""Shares of the largest speed that are commanded."""
SLOWER = 0.9
"""Largest share in movements other than the first, forward, as the thesis has it."""
HOLD = 1.5
"""Mean time between two changes of the command [s]."""
SPREAD = 0.3
"""Holds are drawn from the mean less this to the mean and this [s]: a robot that steps every 0.3 s
would otherwise get each command at the same phase of its gait."""
CHANGING = "changing"
"""Name of the runs in which movement and speed change at contacts, as a planner changes them."""
CHANGING_RUNS = 30
MOST_FOOTSTEPS = 4
"""Largest number of footsteps for which their commands hold."""
COLLECTED = (*MOVEMENTS, CHANGING)
BACKWARD, BACKWARD_MOST = "backward", 0.5
"""A movement of changing runs alone, and the largest share of the forward speed that it gets: a
planner needs it to get away from an edge, or back to a goal that it has passed."""
_AXES = {BACKWARD: (0, -1.0)}
_AXES |= {"forward": (0, 1.0), "left": (1, 1.0), "right": (1, -1.0)}
_AXES |= {"clockwise": (2, -1.0), "counter-clockwise": (2, 1.0)}


class ChangingCommand:
    """The command of a run of all movements, backward, too: drawn, and held for some footsteps.

    Args:
        controller: controller whose largest speeds the shares are of.
        rng: source of movements, speeds and numbers of footsteps.
    """

    def __init__(self, controller: ControllerIdentity, rng: np.random.Generator) -> None:
        self._largest, self._rng = controller.max_speeds, rng
        self._left = 0
        self.now = self._drawn()

    def footstep_ended(self) -> None:
        """Count a footstep, and draw another command after the last one of this."""
        self._left -= 1
        if self._left <= 0:
            self.now = self._drawn()

    def _drawn(self) -> Float[np.ndarray, "3"]:
        movements = (*MOVEMENTS, BACKWARD)
        movement = movements[self._rng.integers(len(movements))]
        self._left = int(self._rng.integers(1, MOST_FOOTSTEPS + 1))
        axis, sign = _AXES[movement]
        command = np.zeros(3)
        command[axis] = sign * self._largest[axis] * self._rng.choice(_shares_of(movement))
        return command


@dataclass(frozen=True)
class CollectionRun:
    """One robot's walk.

    Attributes:
        number: number of the run in its collection.
        movement: movement, one of `COLLECTED`.
        start: share of the largest speed that is commanded first, and returned to.
        higher: shares that are accelerated to, one after the other; empty for a constant speed.
    """

    number: int
    movement: str
    start: float
    higher: tuple[float, ...] = ()

    def __str__(self) -> str:
        if self.movement == CHANGING:
            return self.movement
        what = f"{self.movement} at {self.start:g}"
        return f"{what}, faster in turn" if self.higher else what

    def commands(
        self,
        controller: ControllerIdentity,
        times: Float[np.ndarray, " T"],
        rng: np.random.Generator,
    ) -> Float[np.ndarray, "T 3"]:
        """Return the command at each time: forward, sideways [m/s] and turning [rad/s].

        Those of a changing run depend on contacts; see `ChangingCommand`.

        Args:
            controller: controller whose largest speeds the shares are of.
            times: times since the beginning, ascending [s].
            rng: source of the holds' durations.
        """
        axis, sign = _AXES[self.movement]
        commands = np.zeros((len(times), 3))
        commands[:, axis] = sign * controller.max_speeds[axis] * self._shares(times, rng)
        return commands

    def _shares(
        self, times: Float[np.ndarray, " T"], rng: np.random.Generator
    ) -> Float[np.ndarray, " T"]:
        if not self.higher:
            return np.full(len(times), self.start)
        most = int(times[-1] / (HOLD - SPREAD)) + 2
        changes = np.cumsum(rng.uniform(HOLD - SPREAD, HOLD + SPREAD, most))
        count = np.searchsorted(changes, times, side="right")
        faster = np.array(self.higher)[(count // 2) % len(self.higher)]
        return np.where(count % 2 == 1, faster, self.start)


def plan_runs(movements: Sequence[str]) -> list[CollectionRun]:
    """Return the runs of a collection: for each movement and speed a constant one, and one that
    goes to each higher speed and back; and those that change between all movements.

    Raises:
        InputError: there is no such movement, or none or the same twice is given.
    """
    unknown = [each for each in movements if each not in COLLECTED]
    if unknown or not movements or len(set(movements)) < len(movements):
        raise InputError(
            f"movements {', '.join(movements) or 'none'}: give each at most once, of"
            f" {', '.join(COLLECTED)}"
        )
    runs: list[CollectionRun] = []
    for movement in movements:
        if movement == CHANGING:
            runs += [CollectionRun(0, CHANGING, 0.0)] * CHANGING_RUNS
            continue
        shares = _shares_of(movement)
        runs += [CollectionRun(0, movement, each) for each in shares]
        runs += [
            CollectionRun(0, movement, each, tuple(shares[index + 1 :]))
            for index, each in enumerate(shares[:-1])
        ]
    return [
        CollectionRun(number, each.movement, each.start, each.higher)
        for number, each in enumerate(runs)
    ]


def _shares_of(movement: str) -> list[float]:
    """Return the shares of the largest speed that a movement is commanded with."""
    most = FRACTIONS[-1] if movement == MOVEMENTS[0] else SLOWER
    most = BACKWARD_MOST if movement == BACKWARD else most
    return [each for each in FRACTIONS if each <= most]
