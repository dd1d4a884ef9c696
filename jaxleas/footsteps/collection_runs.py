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
_AXES = {"forward": (0, 1.0), "left": (1, 1.0), "right": (1, -1.0)}
_AXES |= {"clockwise": (2, -1.0), "counter-clockwise": (2, 1.0)}


@dataclass(frozen=True)
class CollectionRun:
    """One robot's walk.

    Attributes:
        number: number of the run in its collection.
        movement: movement, one of `MOVEMENTS`.
        start: share of the largest speed that is commanded first, and returned to.
        higher: shares that are accelerated to, one after the other; empty for a constant speed.
    """

    number: int
    movement: str
    start: float
    higher: tuple[float, ...] = ()

    def __str__(self) -> str:
        what = f"{self.movement} at {self.start:g}"
        return f"{what}, faster in turn" if self.higher else what

    def commands(
        self,
        controller: ControllerIdentity,
        times: Float[np.ndarray, " T"],
        rng: np.random.Generator,
    ) -> Float[np.ndarray, "T 3"]:
        """Return the command at each time: forward, sideways [m/s] and turning [rad/s].

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
    goes to each higher speed and back.

    Raises:
        InputError: there is no such movement, or none or the same twice is given.
    """
    unknown = [each for each in movements if each not in MOVEMENTS]
    if unknown or not movements or len(set(movements)) < len(movements):
        raise InputError(
            f"movements {', '.join(movements) or 'none'}: give each at most once, of"
            f" {', '.join(MOVEMENTS)}"
        )
    runs: list[CollectionRun] = []
    for movement in movements:
        most = FRACTIONS[-1] if movement == MOVEMENTS[0] else SLOWER
        shares = [each for each in FRACTIONS if each <= most]
        runs += [CollectionRun(0, movement, each) for each in shares]
        runs += [
            CollectionRun(0, movement, each, tuple(shares[index + 1 :]))
            for index, each in enumerate(shares[:-1])
        ]
    return [
        CollectionRun(number, each.movement, each.start, each.higher)
        for number, each in enumerate(runs)
    ]
