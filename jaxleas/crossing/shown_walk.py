"""What a command shows of a robot that walks, while it is logged."""

import numpy as np
from jaxtyping import Float

from jaxleas.controllers import Ticked
from jaxleas.crossing.walk_log import WalkLogger
from jaxleas.runs import Progress

_SHOWN = 25
"""Ticks between two updates of the progress."""


class ShownWalk:
    """Shows the progress of a walk, and logs it.

    Args:
        progress: display, which counts ticks.
        logger: log of the walk.
    """

    def __init__(self, progress: Progress, logger: WalkLogger) -> None:
        self._progress, self._logger, self._ticks = progress, logger, 0

    def __call__(self, ticked: Ticked, command: Float[np.ndarray, "N 3"]) -> None:
        """Log one tick, and show where the robot is from time to time."""
        self._logger(ticked, command)
        self._ticks += 1
        if self._ticks % _SHOWN == 0:
            x, y, _ = ticked.walking.sensed.com[0]
            self._progress.update(self._ticks, {"at": f"{x:.2f}, {y:.2f}"})
