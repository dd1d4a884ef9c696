"""Collision of the two legs with each other, by their capsules, such as foot and shank."""

import numpy as np
from jaxtyping import Bool, Float

from jaxleas.contacts.sampling.limbs import PlacedLegs
from jaxleas.robots.legs import LegModel


def leg_segments(legs: LegModel, placed: PlacedLegs) -> Float[np.ndarray, "N C 2 3"]:
    """Return the middle lines of the capsules in the world, as two end points each [m]."""
    capsules = legs.left.capsules
    links = [each.link for each in capsules]
    ends = np.array([(each.start, each.end) for each in capsules]).reshape(-1, 2, 3)
    frames = placed.frames[:, links]
    return ends @ frames.transpose(0, 1, 3, 2) + placed.origins[:, links, None]


def legs_touch(
    legs: LegModel,
    one: Float[np.ndarray, "N C 2 3"],
    other: Float[np.ndarray, "N C 2 3"],
) -> Bool[np.ndarray, " N"]:
    """Return whether two legs, given by their segments, are nearer than their radii allow.

    Args:
        legs: pair of legs.
        one: segments of one leg.
        other: segments of the other leg.
    """
    radii = np.array([each.radius for each in legs.left.capsules])
    first, second = np.indices((len(radii), len(radii))).reshape(2, -1)
    if not len(first):
        return np.zeros(len(one), dtype=bool)
    least = np.repeat(radii[first] + radii[second], len(one))
    pairs = [
        np.moveaxis(segments[:, which], 1, 0).reshape(-1, 2, 3)
        for segments, which in ((one, first), (other, second))
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
