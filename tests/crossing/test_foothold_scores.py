"""FTER and FTS of logs by hand."""

import numpy as np
import pytest

from jaxleas.crossing import (
    FootholdLog,
    foothold_tracking_error,
    landing_errors,
    tracked_footholds,
)

STANDS = np.array([[1, 1, 1, 1], [1, 0, 1, 1], [1, 1, 1, 1], [0, 1, 1, 1]], bool)
"""All stand; RF swings; it stands anew; LF swings."""


@pytest.fixture
def log():
    """Two instants of each of the first three supports; feet are where they are to be."""
    support = np.repeat([0, 1, 2], 2)
    planned = np.zeros((6, 4, 3))
    planned[..., 0] = np.arange(4)
    planned[support == 2, 1, 1] = 0.3
    stands = STANDS[support]
    return FootholdLog(support, stands, planned, planned.copy(), stands.copy())


def test_feet_at_their_places_have_no_error(log):
    assert foothold_tracking_error(log) == 0.0
    assert tracked_footholds(log, STANDS[:3]).tolist() == [True]


def test_the_error_is_a_mean_over_standing_feet_then_over_instants(log):
    log.feet[2, 0] += [0.03, 0.0, 0.04]  # 5 cm, of three feet that stand
    log.feet[0, 3] += [0.0, 0.0, 0.08]  # 8 cm, of four
    log.feet[3, 1] += 9.0  # swings: does not count
    assert foothold_tracking_error(log) == pytest.approx((0.05 / 3 + 0.08 / 4) / 6)


def test_instants_without_a_foot_that_is_to_stand_do_not_count(log):
    log.stands[:5] = False
    log.feet[5, 0, 0] += 0.04
    assert foothold_tracking_error(log) == pytest.approx(0.01)
    log.stands[5] = False
    assert np.isnan(foothold_tracking_error(log))


@pytest.mark.parametrize(
    ("off", "tracked"), [([0.049, 0.0, 0.0], True), ([0.04, 0.04, 0.0], False), ([0, 0, 0.2], True)]
)
def test_a_landing_counts_within_5_cm_seen_from_above(log, off, tracked):
    log.feet[-1, 1] += off
    assert tracked_footholds(log, STANDS[:3]).tolist() == [tracked]


def test_the_end_of_the_support_is_asked_not_its_beginning(log):
    log.feet[4, 1] += 1.0
    assert tracked_footholds(log, STANDS[:3]).tolist() == [True]
    log.touching[5, 1] = False
    assert tracked_footholds(log, STANDS[:3]).tolist() == [False]
    assert not len(landing_errors(log, STANDS[:3]))


def test_supports_that_were_never_walked_count_as_not_tracked(log):
    stands = np.concatenate([STANDS, STANDS[:1]])  # LF would land in a support after the fall
    assert tracked_footholds(log, stands).tolist() == [True, False]
    log.feet[-1, 1] += [0.03, 0.0, 0.0]
    np.testing.assert_allclose(landing_errors(log, stands), [0.03])
