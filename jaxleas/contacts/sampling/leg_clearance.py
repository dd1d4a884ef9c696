"""Collision of the legs with each other, by their capsules, such as foot and shank."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from jaxleas.contacts.sampling.placed_legs import PlacedLegs
from jaxleas.robots import Legs, LimbModel


@dataclass(frozen=True)
class LegCapsules:
    """The capsules of legs in the world, one leg per row.

    Attributes:
        segments: middle lines of the capsules, as two end points each [m].
        radii: radii of the capsules [m]; minus infinity where a leg has fewer than others.
    """

    segments: Float[np.ndarray, "N C 2 3"]
    radii: Float[np.ndarray, "N C"]

    def __getitem__(self, rows) -> "LegCapsules":
        """Return those of some legs."""
        return LegCapsules(self.segments[rows], self.radii[rows])


def leg_capsules(legs: Legs, placed: PlacedLegs) -> LegCapsules:
    """Return the capsules of placed legs.

    Args:
        legs: legs of the robot.
        placed: legs in the world.
    """
    most = max(len(model.capsules) for model in legs.models)
    segments = np.zeros((len(placed), most, 2, 3))
    radii = np.full((len(placed), most), -np.inf)
    for number, rows in legs.by_model(placed.limb):
        model = legs.models[number]
        count = len(model.capsules)
        if count:
            segments[rows, :count] = _segments(model, placed.frames[rows], placed.origins[rows])
            radii[rows, :count] = [each.radius for each in model.capsules]
    return LegCapsules(segments, radii)


def _segments(model: LimbModel, frames: np.ndarray, origins: np.ndarray) -> np.ndarray:
    links = [each.link for each in model.capsules]
    ends = np.array([(each.start, each.end) for each in model.capsules]).reshape(-1, 2, 3)
    return ends @ frames[:, links].transpose(0, 1, 3, 2) + origins[:, links, None]


def legs_touch(one: LegCapsules, other: LegCapsules) -> Bool[np.ndarray, " N"]:
    """Return whether two legs of each row are nearer than the radii of their capsules allow.

    Args:
        one: capsules of one leg of each row.
        other: capsules of the other leg.
    """
    count, capsules = one.radii.shape
    first, second = np.indices((capsules, capsules)).reshape(2, -1)
    if not len(first):
        return np.zeros(count, dtype=bool)
    least = (one.radii[:, first] + other.radii[:, second]).T.reshape(-1)
    pairs = [
        np.moveaxis(each.segments[:, which], 1, 0).reshape(-1, 2, 3)
        for each, which in ((one, first), (other, second))
    ]
    near = segment_distance(*pairs) < least
    return np.any(near.reshape(len(first), -1), axis=0)


def segment_distance(
    first: Float[np.ndarray, "N 2 3"], second: Float[np.ndarray, "N 2 3"]
) -> Float[np.ndarray, " N"]:
    """Return the distance of two segments, none of them a point [m] (Ericson 2005, sec. 5.1.9)."""
    d1, d2 = first[:, 1] - first[:, 0], second[:, 1] - second[:, 0]
    between = first[:, 0] - second[:, 0]
    a, e, b = (d1 * d1).sum(axis=1), (d2 * d2).sum(axis=1), (d1 * d2).sum(axis=1)
    c, f = (d1 * between).sum(axis=1), (d2 * between).sum(axis=1)
    a, e = np.maximum(a, 1e-12), np.maximum(e, 1e-12)
    denominator = a * e - b * b
    parallel = denominator < 1e-12 * a * e
    s = np.where(parallel, 0.0, (b * f - c * e) / np.where(parallel, 1.0, denominator))
    t = (b * np.clip(s, 0.0, 1.0) + f) / e
    t = np.clip(t, 0.0, 1.0)
    s = np.clip((b * t - c) / a, 0.0, 1.0)
    gap = between + s[:, None] * d1 - t[:, None] * d2
    return np.sqrt((gap * gap).sum(axis=1))
