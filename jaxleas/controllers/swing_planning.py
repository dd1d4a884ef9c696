"""The swings that a sequence of supports asks for, each high enough for what is on its way."""

from collections.abc import Callable

import numpy as np
from jaxtyping import Bool, Float

from jaxleas.controllers.phase_tracks import Swings

Heights = Callable[[Float[np.ndarray, "M 2"]], Float[np.ndarray, " M"]]
"""Heights of the ground at places [m]; NaN where there is none."""
SPACING = 0.02
"""Distance of the places at which the ground is read along a swing [m]."""
BESIDE = 0.04
"""Distance to both sides of a swing at which the ground is read, too [m]."""


def plan_swings(
    stands: Bool[np.ndarray, "K+1 E"],
    feet: Float[np.ndarray, "K+1 E 3"],
    times: Float[np.ndarray, " K+2"],
    heights: Heights,
    over: tuple[float, float],
) -> Swings:
    """Return the swings of one robot, with an axis of one robot in front.

    Args:
        stands: whether a foot stands in a support; all do in the first.
        feet: middles of the feet [m].
        times: when each support begins, and last when the plan ends [s].
        heights: heights of the ground.
        over: radius of a foot, and height of a swing above all that is on its way [m].
    """
    count, legs = stands.shape
    first = np.full((count, legs), -1)
    begin, end = np.zeros((count, legs)), np.ones((count, legs))
    touchdown, top = feet.copy(), feet[..., 2].copy()
    for support, foot in np.argwhere(~stands):
        one = support
        while not stands[one - 1, foot]:
            one -= 1
        last = support
        while last < count and not stands[last, foot]:
            last += 1
        first[support, foot] = one
        begin[support, foot], end[support, foot] = times[one], times[last]
        landing = feet[min(last, count - 1), foot]
        touchdown[support, foot] = landing
        top[support, foot] = _top(feet[one - 1, foot], landing, heights, over)
    return Swings(first[None], begin[None], end[None], touchdown[None], top[None])


def _top(
    lift_off: Float[np.ndarray, "3"],
    landing: Float[np.ndarray, "3"],
    heights: Heights,
    over: tuple[float, float],
) -> float:
    """Return the height of a foot's middle that clears all on its way."""
    radius, clearance = over
    way = landing[:2] - lift_off[:2]
    length = float(np.hypot(*way))
    shares = np.linspace(0.0, 1.0, 2 + int(length / SPACING))
    along = lift_off[:2] + shares[:, None] * way
    aside = np.array([-way[1], way[0]]) * (BESIDE / max(length, 1e-9))
    found = heights(np.concatenate([along - aside, along, along + aside]))
    highest = np.nanmax(found + radius, initial=max(lift_off[2], landing[2]))
    return float(highest) + clearance
