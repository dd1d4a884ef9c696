"""Do the two legs bump into each other? Feet and shanks as capsules."""

import numpy as np
from jaxtyping import Bool, Float

from jaxleas.contacts.sampling.limbs import PlacedLegs
from jaxleas.robots.legs import LegModel

FOOT_RADIUS = 0.065
"""Of a foot's capsule: half its width [m]."""
SHANK_RADIUS = 0.065
"""Of a shank's capsule [m]."""
_PAIRS = ((0, 0), (1, 1), (0, 1), (1, 0))  # foot and foot, shank and shank, foot and shank twice


def leg_segments(legs: LegModel, placed: PlacedLegs) -> Float[np.ndarray, "N 2 2 3"]:
    """Return the middle lines of foot and shank in the world, as two end points each [m]."""
    forward, up = placed.frames[:, 5, :, 0], placed.frames[:, 5, :, 2]
    middle = placed.sole + FOOT_RADIUS * up
    segments = np.empty((len(middle), 2, 2, 3))
    segments[:, 0, 0] = middle + (legs.foot_box.low[0] + FOOT_RADIUS) * forward
    segments[:, 0, 1] = middle + (legs.foot_box.high[0] - FOOT_RADIUS) * forward
    segments[:, 1] = placed.origins[:, 3:5]
    return segments


def legs_touch(
    one: Float[np.ndarray, "N 2 2 3"], other: Float[np.ndarray, "N 2 2 3"]
) -> Bool[np.ndarray, " N"]:
    """Tell whether two legs, given by their segments, are nearer than their radii allow."""
    radii = (FOOT_RADIUS, SHANK_RADIUS)
    first = np.concatenate([one[:, a] for a, _ in _PAIRS])
    second = np.concatenate([other[:, b] for _, b in _PAIRS])
    least = np.repeat([radii[a] + radii[b] for a, b in _PAIRS], len(one))
    near = segment_distance(first, second) < least
    return np.any(near.reshape(len(_PAIRS), -1), axis=0)


def segment_distance(
    first: Float[np.ndarray, "N 2 3"], second: Float[np.ndarray, "N 2 3"]
) -> Float[np.ndarray, " N"]:
    """Return the distance of two segments that are no points [m] (Ericson 2005, sec. 5.1.9)."""
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
