"""The phase tracker's parts: references, swings, forces in cones, and feet at given places."""

import numpy as np
import pytest
from scipy.optimize import minimize

from jaxleas.controllers import joined, plan_swings, standing_with
from jaxleas.controllers.cone_forces import IMPORTANCE, SMALL, cone_forces
from jaxleas.controllers.high_swing import high_swing
from jaxleas.controllers.stance import grasp_of
from jaxleas.gaits import quickened, track_of
from jaxleas.physics import load_body, make_physics
from jaxleas.types import InputError
from tests.controllers.tracks import one_step

BODY = load_body("anymal_b")
OVER = (BODY.foot_radius, 0.06)


def level(places):
    return np.zeros(len(places))


@pytest.fixture(scope="module")
def tracks():
    return track_of(one_step(), level, OVER)


def test_velocity_and_acceleration_are_those_of_the_curve(tracks):
    h = 1e-4
    for time in (0.3, 0.9, 1.8, 2.9):
        before, now, after = (tracks.at(np.array([time + d])) for d in (-h, 0.0, h))
        np.testing.assert_allclose((after.com - before.com) / (2 * h), now.velocity, atol=1e-5)
        bend = (after.com - 2.0 * now.com + before.com) / h**2
        np.testing.assert_allclose(bend, now.acceleration, atol=1e-3)
        np.testing.assert_allclose((after.yaw - before.yaw) / (2 * h), now.yaw_rate, atol=1e-6)


def test_the_reference_passes_through_the_phases_and_rests_at_both_ends(tracks):
    plan = one_step()
    for phase, time in enumerate((0.0, 1.6, 3.2)):
        found = tracks.at(np.array([time]))
        np.testing.assert_allclose(found.com[0], plan.phases.com[phase], atol=1e-6)
        np.testing.assert_allclose(found.yaw[0], plan.phases.yaw[phase], atol=1e-6)
    for time in (-1.0, 3.3):
        assert not tracks.at(np.array([time])).velocity.any()


def test_supports_change_where_the_plan_says(tracks):
    supports = [int(tracks.at(np.array([time])).support[0]) for time in (0.7, 0.9, 2.3, 2.5, 9.0)]
    assert supports == [0, 1, 1, 2, 2]
    assert tracks.at(np.array([1.0])).stands[0].tolist() == [True, True, False, True]


def test_a_swing_lasts_its_support_and_ends_at_the_next_foothold(tracks):
    swings = tracks.swings
    assert (swings.begin[0, 1, 2], swings.end[0, 1, 2]) == pytest.approx((0.8, 2.4))
    np.testing.assert_allclose(swings.touchdown[0, 1, 2, :2], [-0.22, 0.2], atol=1e-6)
    assert (swings.first[0] >= 0).sum() == 1


def test_a_swing_rises_above_what_is_on_its_way(tracks):
    feet = np.tile(one_step().phases.feet[:1], (3, 1, 1)).astype(float)
    feet[1:, 0, 0] += 0.3
    stands = np.ones((3, 4), bool)
    stands[1, 0] = False

    def wall(places):
        return np.where(np.abs(places[:, 0] - 0.5) < 0.05, 0.1, np.nan)

    times = np.array([0.0, 1.0, 2.0, 3.0])
    swings = plan_swings(stands, feet, times, wall, (0.03, 0.05))
    assert swings.top[0, 1, 0] == pytest.approx(0.1 + 0.03 + 0.05)


def test_plans_of_different_lengths_are_padded(tracks):
    long = one_step()
    both = joined([tracks, track_of(long, level, OVER)])
    short = joined([tracks])
    assert len(both) == 2
    for time in (0.5, 1.7, 4.0):
        one, two = short.at(np.array([time])), both.at(np.array([time, time]))
        np.testing.assert_allclose(two.com, np.repeat(one.com, 2, axis=0))


def test_a_plan_is_quicker_where_its_programs_allow_it():
    plan = one_step()
    quick = quickened(plan, 2.0)
    assert (quick.times <= plan.times).all()
    assert quick.times.sum() < plan.times.sum()
    assert (quickened(plan, 1.0).times == plan.times).all()


def test_a_plan_without_transitions_is_refused():
    from dataclasses import replace

    from jaxleas.gaits import taken

    plan = one_step()
    empty = replace(plan, phases=taken(plan.phases, slice(0, 1)), times=plan.times[:0])
    with pytest.raises(InputError, match="nothing to track"):
        track_of(empty, level, OVER)


def test_a_high_swing_begins_and_ends_at_rest_and_its_velocity_is_its_derivative():
    lift, land = np.array([[[0.0, 0.1, 0.03]]]), np.array([[[0.3, 0.0, 0.11]]])
    top, lasts = np.array([[0.2]]), np.array([[0.8]])

    def at(progress):
        return high_swing(lift, land, top, np.array([[progress]]), lasts)

    np.testing.assert_allclose(at(0.0).place, lift)
    np.testing.assert_allclose(at(1.0).place, land)
    assert at(0.5).place[0, 0, 2] == pytest.approx(0.2)
    assert not at(0.0).velocity.any()
    assert np.abs(at(1.0).velocity).max() < 1e-12
    h = 1e-5
    for progress in (0.1, 0.3, 0.5, 0.75, 0.95):
        before, after = at(progress - h), at(progress + h)
        step = 2.0 * h * lasts[0, 0]
        speed = (after.place - before.place) / step
        np.testing.assert_allclose(speed, at(progress).velocity, atol=1e-6)
        push = (after.velocity - before.velocity) / step
        np.testing.assert_allclose(push, at(progress).acceleration, atol=1e-4)


ARMS = np.array([[[0.3, 0.2, -0.45], [0.3, -0.2, -0.45], [-0.3, 0.2, -0.45], [-0.3, -0.2, -0.45]]])


def cost(forces, wrench, stands):
    error = IMPORTANCE * ((grasp_of(ARMS, stands)[0] @ forces.reshape(-1)) - wrench)
    return error @ error + SMALL * (forces**2).sum()


@pytest.mark.parametrize(
    ("wrench", "standing"),
    [
        ([0, 0, 300, 0, 0, 0], [1, 1, 1, 1]),  # inside the cones
        ([0, 0, 300, 60, 50, 0], [1, 1, 1, 1]),  # a foot would have to pull
        ([0, 0, 300, 0, 0, 0], [1, 1, 0, 1]),  # on an edge of the triangle
        ([200, 0, 300, 0, 0, 20], [1, 1, 1, 1]),  # a foot would slip
    ],
)
def test_forces_are_the_best_within_their_pyramids(wrench, standing):
    wrench, stands = np.array(wrench, float), np.array([standing], bool)
    found = cone_forces(wrench[None], ARMS, stands, 0.6, 10.0)[0]
    assert not found[~stands[0]].any()
    up = found[stands[0], 2]
    assert (up >= 10.0 - 1e-9).all()
    assert (np.hypot(*found[stands[0], :2].T) <= 0.6 * up + 1e-6).all()

    # The slow twin: SciPy's SLSQP over the same pyramids, |fx| + |fy| <= mu (fz - least).
    free = np.flatnonzero(np.repeat(stands[0], 3))

    def whole(some):
        forces = np.zeros(12)
        forces[free] = some
        return forces

    signs = [(1, 1), (1, -1), (-1, 1), (-1, -1)]
    limits = [{"type": "ineq", "fun": lambda some, a=a, b=b: _room(some, a, b)} for a, b in signs]
    begin = np.tile([0.0, 0.0, 100.0], int(stands.sum()))
    best = minimize(
        lambda some: cost(whole(some), wrench, stands) / 1e3,
        begin,
        constraints=limits,
        method="SLSQP",
        options={"maxiter": 500, "ftol": 1e-12},
    )
    assert cost(found, wrench, stands) <= 1e3 * best.fun * (1.0 + 1e-4) + 1e-3


def _room(some, a, b):
    forces = some.reshape(-1, 3)
    return 0.6 * (forces[:, 2] - 10.0) - a * forces[:, 0] - b * forces[:, 1]


def test_a_robot_stands_with_its_feet_where_they_are_to_be():
    plan = one_step()
    feet = plan.phases.feet[:1].astype(float)
    feet[..., 2] += BODY.foot_radius
    feet[0, 0, 2] += 0.1  # one stands higher
    start, apart = standing_with(BODY, plan.phases.com[:1].astype(float), np.zeros(1), feet)
    assert apart.max() < 1e-4
    measured = make_physics(BODY, 1).step(start, np.zeros((1, 12))).sensed.feet
    np.testing.assert_allclose(measured, feet, atol=1e-3)
