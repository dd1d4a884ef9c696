"""How well footholds of a plan were tracked: FTER and FTS of Tsounis et al. 2020, "DeepGait"."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int

NEAR = 0.05
"""Horizontal distance from its foothold within which a landing counts [m]."""


@dataclass(frozen=True, eq=False)
class FootholdLog:
    """What was planned for a robot's E feet, and what was measured, at T instants.

    Attributes:
        support: number of the plan's support at each instant.
        stands: whether a foot is to stand.
        planned: where a foot is to stand, or is next [m].
        feet: measured places, in the same sense [m].
        touching: whether a foot touches the ground.
    """

    support: Int[np.ndarray, " T"]
    stands: Bool[np.ndarray, "T E"]
    planned: Float[np.ndarray, "T E 3"]
    feet: Float[np.ndarray, "T E 3"]
    touching: Bool[np.ndarray, "T E"]


def foothold_tracking_error(log: FootholdLog) -> float:
    """Return FTER, the mean distance of feet that are to stand from their footholds [m] (eq. 5).

    At each instant the mean is over the feet that the plan lets stand, whether they touch or not;
    instants at which none is to stand do not count. NaN where none is left.

    Args:
        log: what was planned and measured.
    """
    distance = np.linalg.norm(log.planned - log.feet, axis=2)
    counts = log.stands.sum(axis=1)
    some = counts > 0
    if not some.any():
        return float("nan")
    sums = np.where(log.stands, distance, 0.0).sum(axis=1)
    return float((sums[some] / counts[some]).mean())


def tracked_footholds(
    log: FootholdLog, stands: Bool[np.ndarray, "K+1 E"], near: float = NEAR
) -> Bool[np.ndarray, " F"]:
    """Return whether each new foothold of a plan was tracked, in their order; FTS is the mean.

    A foothold is new where a foot is to stand in a support and not in the one before. It is
    tracked if the foot touches the ground within `near` of it, seen from above, at the last instant
    of that support (sec. IV-C). Those of supports that were never walked are not tracked: a fall
    does not shorten the plan.

    Args:
        log: what was planned and measured.
        stands: whether each foot is to stand in each support of the plan.
        near: horizontal distance that is still near [m].
    """
    found = []
    for support, foot in np.argwhere(stands[1:] & ~stands[:-1]):
        apart = _apart_at_end(log, support + 1, foot)
        found.append(apart is not None and apart <= near)
    return np.array(found, bool)


def landing_errors(log: FootholdLog, stands: Bool[np.ndarray, "K+1 E"]) -> Float[np.ndarray, " F"]:
    """Return the horizontal distances from new footholds, at the ends of their supports [m].

    Feet that do not touch the ground then, and supports that were never walked, have none.

    Args:
        log: what was planned and measured.
        stands: whether each foot is to stand in each support of the plan.
    """
    found = (
        _apart_at_end(log, support + 1, foot)
        for support, foot in np.argwhere(stands[1:] & ~stands[:-1])
    )
    return np.array([each for each in found if each is not None])


def _apart_at_end(log: FootholdLog, support: int, foot: int) -> float | None:
    """Return how far a foot is from its foothold at a support's end [m]; None if it is not down."""
    instants = np.flatnonzero(log.support == support)
    if not len(instants) or not log.touching[instants[-1], foot]:
        return None
    off = (log.feet - log.planned)[instants[-1], foot, :2]
    return float(np.hypot(*off))
