"""The parts of the trot by themselves: laws, and slow twins that share no code."""

import numpy as np
import pytest
from scipy.optimize import lsq_linear

from jaxleas.controllers.clock import schedule
from jaxleas.controllers.ground import GroundPlane
from jaxleas.controllers.legs import LegKinematics
from jaxleas.controllers.stance import ground_forces
from jaxleas.controllers.swing import swing_target
from jaxleas.physics import import_mujoco, load_body

BODY = load_body("anymal_b")
RNG = np.random.default_rng(0)


def test_feet_and_jacobians_are_those_of_mujoco() -> None:
    mujoco = import_mujoco()
    model = mujoco.MjModel.from_xml_string(BODY.mjcf)
    data = mujoco.MjData(model)
    angles = RNG.uniform(-1.5, 1.5, (5, 12))
    posture = LegKinematics(BODY).posture(angles)
    for index in range(5):
        data.qpos[:7] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]
        data.qpos[7:] = angles[index]
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        for leg, name in enumerate(BODY.feet):
            site, jacobian = model.site(name).id, np.zeros((3, model.nv))
            mujoco.mj_jacSite(model, data, jacobian, None, site)
            np.testing.assert_allclose(posture.feet[index, leg], data.site_xpos[site], atol=1e-12)
            own = jacobian[:, 6 + 3 * leg : 9 + 3 * leg]
            np.testing.assert_allclose(posture.jacobians[index, leg], own, atol=1e-12)


def test_ground_forces_are_the_least_squares_of_another_program() -> None:
    arms = RNG.uniform(-0.4, 0.4, (20, 4, 3))
    arms[..., 2] = -0.45
    stands = RNG.random((20, 4)) < 0.6
    wrench = RNG.normal(0.0, 10.0, (20, 6))
    wrench[:, 2] += 300.0
    forces = ground_forces(wrench, arms, stands, friction=1e9)
    for index in range(20):
        feet = np.flatnonzero(stands[index])
        grasp = np.zeros((6, 3 * len(feet)))
        for column, foot in enumerate(feet):
            for axis, unit in enumerate(np.eye(3)):
                grasp[:3, 3 * column + axis] = unit
                grasp[3:, 3 * column + axis] = np.cross(arms[index, foot], unit)
        assert not forces[index, ~stands[index]].any()
        if len(feet) < 3:
            continue
        regular = np.concatenate([grasp, 0.01 * np.eye(3 * len(feet))])
        best = lsq_linear(regular, np.concatenate([wrench[index], np.zeros(3 * len(feet))])).x
        if (best[2::3] > 0.0).all():
            np.testing.assert_allclose(forces[index, feet].ravel(), best, atol=1e-6)


def test_ground_forces_push_and_stay_in_their_cones() -> None:
    wrench = RNG.normal(0.0, 300.0, (50, 6))
    forces = ground_forces(wrench, RNG.normal(0, 0.4, (50, 4, 3)), np.ones((50, 4), bool), 0.5)
    assert (forces[..., 2] >= 0.0).all()
    along = np.linalg.norm(forces[..., :2], axis=-1)
    assert (along <= 0.5 * forces[..., 2] + 1e-9).all()
    assert along.max() > 10.0


def test_a_swing_begins_and_ends_at_rest_and_its_derivatives_are_true() -> None:
    start, end = np.zeros((1, 1, 3)), np.array([[[0.3, -0.1, 0.05]]])

    def at(progress: float):
        return swing_target(start, end, np.array([[progress]]), 0.27, 0.065)

    np.testing.assert_allclose(at(0.0).place, start, atol=1e-15)
    np.testing.assert_allclose(at(1.0).place, end, atol=1e-15)
    for edge in (0.0, 1.0):
        np.testing.assert_allclose(at(edge).velocity, 0.0, atol=1e-12)
    way = at(0.5).place[0, 0] / end[0, 0]
    assert way[0] == pytest.approx(way[1])
    assert at(0.5).place[0, 0, 2] == pytest.approx(0.065 + 0.05 * way[0])
    np.testing.assert_array_equal(at(0.19).place[0, 0, :2], 0.0)  # it rises first
    assert at(0.19).place[0, 0, 2] > 0.01
    step = 1e-5
    for progress in (0.1, 0.4, 0.5, 0.83):
        late, early = at(progress + step), at(progress - step)
        scale = 2.0 * step * 0.27
        there = at(progress)
        np.testing.assert_allclose(there.velocity, (late.place - early.place) / scale, atol=1e-6)
        slope = (late.velocity - early.velocity) / scale
        np.testing.assert_allclose(there.acceleration, slope, atol=1e-4)


def test_the_ground_is_the_plane_of_another_program() -> None:
    feet = np.array([[0.4, 0.2], [0.35, -0.2], [-0.35, 0.2], [-0.4, -0.25]])
    heights = RNG.uniform(-0.05, 0.05, (10, 4))
    footholds = np.concatenate([feet + np.zeros((10, 4, 2)), heights[..., None]], axis=2) + 3.0
    ground = GroundPlane.through(footholds)
    for index in range(10):
        rows = np.column_stack([footholds[index, :, :2], np.ones(4)])
        found = np.linalg.lstsq(rows, footholds[index, :, 2], rcond=None)[0]
        # Ours pulls slopes towards 0 by the thousandth of a square metre that keeps it firm.
        np.testing.assert_allclose(ground.gradient[index], found[:2], atol=2e-3)
        places = RNG.uniform(2.5, 3.5, (4, 2))
        expected = np.column_stack([places, np.ones(4)]) @ found
        np.testing.assert_allclose(ground.height_at(places[None])[index], expected, atol=2e-3)


def test_the_ground_under_feet_in_one_line_is_level_across_it() -> None:
    footholds = np.array([[[x, 0.0, 0.1 * x] for x in (-0.4, -0.1, 0.2, 0.4)]])
    np.testing.assert_allclose(GroundPlane.through(footholds).gradient, [[0.1, 0.0]], atol=1e-3)


def test_the_clock_gives_each_foot_its_share() -> None:
    phase = np.arange(1000) / 1000.0
    planned = schedule(phase, np.array([0.0, 0.5, 0.5, 0.0]), 0.55)
    np.testing.assert_allclose(planned.swings.mean(axis=0), 0.45, atol=2e-3)
    assert (planned.swings[:, 0] == planned.swings[:, 3]).all()
    assert not (planned.swings[:, 0] & planned.swings[:, 1]).any()
    assert planned.all_stand.mean() == pytest.approx(0.1, abs=5e-3)
    assert planned.progress.min() >= 0.0
    assert planned.progress.max() < 1.0
