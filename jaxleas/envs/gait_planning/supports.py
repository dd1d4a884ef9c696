"""The five supports that a phase may have, and how an action names one."""

import numpy as np
from jaxtyping import Bool, Float, Int

from jaxleas.envs.gait_planning.quadruped import FEET

STANDING = np.concatenate([np.ones((1, 4), bool), ~np.eye(len(FEET), dtype=bool)])
"""Feet in contact of each support [support, foot]: all four, then all but LF, RF, LH, RH."""
SUPPORTS = len(STANDING)
MIRRORED = (0, 2, 1, 4, 3)
"""Support that each support becomes when left and right are swapped."""
CODE_SIZE = 3
CODE_MIRROR = (1.0, 1.0, -1.0)


def decode(code: Float[np.ndarray, "N 3"]) -> Int[np.ndarray, " N"]:
    """Return the support that three numbers name, f_dec of D table I.

    The first says whether a foot swings, the second whether it is a hind one, the third whether it
    is a right one; a number above 0 is yes. So half of the codes are four feet in contact.
    """
    swings, hind, right = (code > 0.0).T
    return np.where(swings, 1 + 2 * hind + right, 0)


def in_contact(support: Int[np.ndarray, "*batch"]) -> Bool[np.ndarray, "*batch 4"]:
    """Return whether each foot is in contact."""
    return STANDING[support]
