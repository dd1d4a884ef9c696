"""What becomes of a robot that follows a gait plan."""

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from jaxtyping import Bool, Float

from jaxleas.crossing.foothold_scores import FootholdLog, foothold_tracking_error

Followed = Literal["followed", "astray", "fell", "time", "interrupted"]
"""It stands at the end of its plan; it stands elsewhere; it fell; its time was over before; a
person stopped it."""
FOLLOWED: tuple[Followed, ...] = get_args(Followed)


@dataclass(frozen=True, eq=False)
class Tracking:
    """What became of one robot that follows a plan.

    Attributes:
        outcome: how it ended.
        time: time of the end [s].
        support: number of the plan's support in which it ended.
        cause: what showed a fall, one of `jaxleas.controllers.FALLS`; "" otherwise.
        com: last position of the centre of mass [m].
        base_errors: distance of the centre of mass from its place at each instant [m].
        tracked: whether each new foothold of the plan was tracked.
        landing_errors: horizontal distances of landed feet from their new footholds [m].
        log: what was planned of its feet, and measured.
    """

    outcome: Followed
    time: float
    support: int
    cause: str
    com: Float[np.ndarray, "3"]
    base_errors: Float[np.ndarray, " T"]
    tracked: Bool[np.ndarray, " F"]
    landing_errors: Float[np.ndarray, " G"]
    log: FootholdLog

    @property
    def fter(self) -> float:
        """Mean distance of standing feet from their footholds: `foothold_tracking_error` [m]."""
        return foothold_tracking_error(self.log)

    @property
    def fts(self) -> float:
        """Share of the plan's new footholds that were tracked; 1 of a plan without any."""
        return float(self.tracked.mean()) if len(self.tracked) else 1.0
