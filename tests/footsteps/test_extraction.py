"""Footsteps in made-up logs whose footsteps are known, by both definitions."""

import numpy as np
import pytest

from jaxleas.footsteps.extraction import extract_footsteps
from jaxleas.footsteps.samples import Samples
from jaxleas.types import ControllerIdentity

TROT = ControllerIdentity(
    *("trot", "anymal_b", ("LF", "RF", "LH", "RH"), ((0, 3), (1, 2)), 0.065, 0.031),
    *((1.0, 0.5, 1.0), {"cycle": 0.6, "duty": 0.55}),
)
TICK = 0.004


def log(swings: list[tuple[tuple[int, ...], float]], stride: float = 0.1) -> Samples:
    """Return a log in which feet swing in turn, to a height each; 30 ms of standing between."""
    stand, swing = 8, 67
    heights, forces, x = [], [], np.zeros(4)
    places = []
    for feet, apex in swings:
        progress = (np.arange(swing) + 1.0) / (swing + 1)
        rise = np.zeros((stand + swing, 4))
        pushed = np.full((stand + swing, 4), 75.0)
        along = np.tile(x, (stand + swing, 1))
        for foot in feet:
            rise[stand:, foot] = apex * np.sin(np.pi * progress)
            pushed[stand:, foot] = 0.0
            along[stand:, foot] += stride * progress
            x[foot] += stride
        heights.append(rise)
        forces.append(pushed)
        places.append(along)
    heights.append(np.zeros((stand, 4)))
    forces.append(np.full((stand, 4), 75.0))
    places.append(np.tile(x, (stand, 1)))
    z = np.concatenate(heights) + 0.031
    ticks = len(z)
    feet = np.stack([np.concatenate(places), np.zeros((ticks, 4)), z], axis=-1)
    time = TICK * np.arange(ticks)
    command = np.zeros((ticks, 3))
    command[:, 0] = np.where(time < 0.7, 0.2, 0.4)
    com = np.stack([feet[..., 0].mean(axis=1), np.zeros(ticks), np.full(ticks, 0.45)], axis=1)
    still = np.zeros((ticks, 3))
    forces_all = np.concatenate(forces)
    return Samples(time, command, feet, forces_all, com, still, np.zeros(ticks), np.zeros(ticks))


@pytest.mark.parametrize("definition", ["thesis", "contact"])
def test_the_footsteps_of_a_trot_are_found(definition) -> None:
    samples = log([((0, 3), 0.065), ((1, 2), 0.065), ((0, 3), 0.07), ((1, 2), 0.06)])
    found = extract_footsteps(samples, 7, TROT, definition)
    footsteps = found.footsteps
    assert footsteps.pair.tolist() == [0, 1, 0, 1]
    assert footsteps.run.tolist() == [7] * 4
    np.testing.assert_allclose(np.diff(footsteps.time), 0.3, atol=0.01)
    np.testing.assert_allclose(footsteps.apex, [0.065, 0.065, 0.07, 0.06], atol=1e-3)
    moved = footsteps.feet_after - footsteps.feet_before
    wanted = 0.1 * np.array([[1, 0, 0, 1], [0, 1, 1, 0], [1, 0, 0, 1], [0, 1, 1, 0]])
    np.testing.assert_allclose(moved[..., 0], wanted, atol=0.005)
    np.testing.assert_allclose(footsteps.com_before[1:], footsteps.com_after[:-1])
    # The third is commanded 0.2 at its first moment and 0.4 for most of it.
    assert footsteps.command[:, 0].tolist() == [0.2, 0.2, 0.4, 0.4]
    assert footsteps.previous_command[:, 0].tolist() == [0.2, 0.2, 0.2, 0.4]
    assert not found.rejected


@pytest.mark.parametrize("definition", ["thesis", "contact"])
@pytest.mark.parametrize(
    ("feet", "apex", "reason"),
    [
        ((0, 3), 0.03, "apex far from the set height"),
        ((0, 3), 0.10, "apex far from the set height"),
        ((0,), 0.065, "not one pair alone swung"),
        ((0, 3), 0.015, "no foot swung"),
    ],
)
def test_what_is_no_footstep_is_counted_by_its_reason(definition, feet, apex, reason) -> None:
    samples = log([((1, 2), 0.065), (feet, apex), ((1, 2), 0.065)])
    found = extract_footsteps(samples, 0, TROT, definition)
    assert found.footsteps.pair.tolist() == [1, 1]
    assert found.rejected == {reason: 1}
    # The next footstep begins where the refused one ended.
    assert found.footsteps.time[1] - found.footsteps.time[0] == pytest.approx(0.6, abs=0.01)


def test_two_front_feet_are_no_pair_of_a_trot() -> None:
    """By contact; at one height they are level for the thesis's definition."""
    samples = log([((1, 2), 0.065), ((0, 1), 0.065), ((1, 2), 0.065)])
    found = extract_footsteps(samples, 0, TROT, "contact")
    assert found.rejected == {"not one pair alone swung": 1}


def test_contact_that_bounces_does_not_end_a_second_footstep() -> None:
    samples = log([((0, 3), 0.065), ((1, 2), 0.065)])
    samples.forces[78, 0] = 0.0  # in the stance after the first swing
    found = extract_footsteps(samples, 0, TROT, "contact")
    assert found.footsteps.pair.tolist() == [0, 1]
    assert found.rejected == {"too soon after the one before": 1}


def test_a_log_without_a_standing_moment_has_no_footsteps() -> None:
    samples = log([((0, 3), 0.065)])
    samples.forces[:] = 0.0
    assert len(extract_footsteps(samples, 0, TROT, "contact").footsteps) == 0
