"""The contact code of D table I."""

from itertools import product

import numpy as np

from jaxleas.envs.gait_planning.quadruped import FEET
from jaxleas.envs.gait_planning.supports import CODE_MIRROR, MIRRORED, STANDING, decode

CODES = np.array(list(product((-0.5, 0.5), repeat=3)))


def test_half_of_the_codes_stand_on_four_feet_and_an_eighth_swings_each():
    counts = np.bincount(decode(CODES), minlength=5)
    assert counts.tolist() == [4, 1, 1, 1, 1]
    assert STANDING.sum(axis=1).tolist() == [4, 3, 3, 3, 3]
    swinging = [FEET[int(np.flatnonzero(~row)[0])] for row in STANDING[1:]]
    assert swinging == ["LF", "RF", "LH", "RH"]


def test_a_mirrored_code_swings_the_foot_on_the_other_side():
    np.testing.assert_array_equal(decode(CODES * CODE_MIRROR), np.asarray(MIRRORED)[decode(CODES)])
