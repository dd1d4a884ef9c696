"""How much of a long judgement is done, and how long the rest will take."""

import time
from collections.abc import Callable

from jaxleas.evaluation.suites import Cell, Suite
from jaxleas.evaluation.titles import cell_title, method_title


class Forecast:
    """Counts guide paths as they are judged, and reports progress in words.

    A planner's remaining time is forecast from what its own cells have taken, in proportion to
    their starts and to how long their walks may be.

    Args:
        suite: suite that is judged.
        methods: number of methods.
        planners: names of the planners; (None,) without any.
        say: callable that shows a line.
        clock: current time [s]; tests replace it.
    """

    def __init__(
        self,
        suite: Suite,
        methods: int,
        planners: tuple[str | None, ...],
        say: Callable[[str], None],
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._suite, self._say, self._clock = suite, say, clock
        load = methods * sum(self._load(cell) for cell in suite.cells)
        self._left = dict.fromkeys(planners, float(load))
        self._taken: dict[str | None, tuple[float, float]] = {}
        self._total = methods * len(planners) * len(suite.cells)
        self._done, self._guides, self._since = 0, 0, clock()

    def skip(self, cell: Cell, planner: str | None) -> None:
        """Count a result that existed already."""
        self._done += 1
        self._left[planner] -= self._load(cell)

    def guides(self, cell: Cell, method: str, planner: str | None, count: int) -> None:
        """Report that `count` more guide paths of a cell are judged; 0 reports that it begins."""
        self._guides = 0 if count == 0 else self._guides + count
        where = f"{method_title(method)} on {cell_title(cell.name)} at {cell.yaw:.0f} deg"
        whose = "walks" if planner is None else f"{planner}, {self._guides} guide paths"
        line = f"{self._suite.name} {self._done + 1}/{self._total}: {where}: {whose}"
        self._say(f"{line}; {self.left()} left" if self._taken else line)

    def result(self, cell: Cell, planner: str | None) -> None:
        """Count a result that took time to compute."""
        now = self._clock()
        seconds, load = self._taken.get(planner, (0.0, 0.0))
        self._taken[planner] = (seconds + now - self._since, load + self._load(cell))
        self._left[planner] -= self._load(cell)
        self._done, self._since = self._done + 1, now

    def left(self) -> str:
        """Return the time left as minutes:seconds; unseen planners are rated like the others."""
        rates = {name: seconds / load for name, (seconds, load) in self._taken.items()}
        usual = sum(rates.values()) / max(len(rates), 1)
        seconds = sum(load * rates.get(name, usual) for name, load in self._left.items())
        return f"{int(seconds) // 60}:{int(seconds) % 60:02d}"

    def _load(self, cell: Cell) -> float:
        return float(cell.starts * self._suite.steps_of(cell))
