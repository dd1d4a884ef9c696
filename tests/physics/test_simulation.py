"""The step of physics: MuJoCo's own, on any scene, for robots that differ."""

import subprocess
import sys

import numpy as np
import pytest

from jaxleas.physics import (
    BodyState,
    Physics,
    Variation,
    import_mujoco,
    load_body,
    make_physics,
    standing,
)
from jaxleas.terrain import Scene
from jaxleas.types import InputError

BODY = load_body("anymal_b")


def stand(physics: Physics, state: BodyState, ticks: int) -> tuple[BodyState, np.ndarray]:
    """Return the state after robots stood by a spring in each joint, and the forces on feet."""
    forces = np.zeros((len(state), 4))
    for _ in range(ticks):
        torques = 200.0 * (BODY.standing - state.angles) - 8.0 * state.joint_speeds
        stepped = physics.step(state, torques, 2)
        state, forces = stepped.state, stepped.sensed.forces
    return state, forces


def plain(mjcf: str, state: BodyState, torques: np.ndarray, count: int) -> np.ndarray:
    """Return coordinates and sensors by MuJoCo's own loop, of one robot."""
    mujoco = import_mujoco()
    model = mujoco.MjModel.from_xml_string(mjcf)
    data = mujoco.MjData(model)
    data.qpos[:], data.qvel[:], data.ctrl[:] = state.coordinates[0], state.speeds[0], torques[0]
    for _ in range(count):
        mujoco.mj_step(model, data)
    return np.concatenate([data.qpos, data.qvel, data.sensordata])


def test_a_step_is_that_of_plain_mujoco() -> None:
    physics = make_physics(BODY, 3)
    state, _ = stand(physics, standing(BODY, np.zeros((3, 3)), np.array([0.0, 1.0, 2.0])), 5)
    torques = np.random.default_rng(0).normal(0.0, 20.0, (3, 12))
    stepped = physics.step(state, torques, 4)
    sensed = stepped.sensed
    ours = np.concatenate(
        [
            *(stepped.state.coordinates[0], stepped.state.speeds[0], sensed.feet[0].ravel()),
            *(sensed.forces[0], sensed.com[0], sensed.com_velocity[0]),
            *(sensed.quaternion[0], sensed.turning_rate[0]),
        ]
    )
    np.testing.assert_array_equal(ours, plain(physics.mjcf, state, torques, 4))
    assert stepped.sensed.time == pytest.approx(stepped.states[-2].time)
    assert len(stepped.states) == 4


def test_standing_feet_carry_the_weight() -> None:
    _, forces = stand(make_physics(BODY, 1), standing(BODY, np.zeros((1, 3))), 150)
    assert forces.sum() == pytest.approx(9.81 * BODY.mass, rel=0.01)


def test_robots_differ_by_their_variation() -> None:
    variation = Variation(np.array([0.2, 1.0, 0.2]), np.array([1.0, 1.0, 1.1]))
    physics = make_physics(BODY, 3, variation=variation)
    _, forces = stand(physics, standing(BODY, np.zeros((3, 3))), 150)
    trunk = 16.8435
    heavier = forces.sum(axis=1) - 9.81 * BODY.mass
    np.testing.assert_allclose(heavier, [0.0, 0.0, 0.1 * trunk * 9.81], atol=0.5)
    # On a slope of 30 degrees, a friction of 0.2 slides; one of 1 holds, as springs bend.
    half = np.deg2rad(15.0)
    slope = np.tan(2.0 * half)
    corners = np.array([[-3.0, -3.0, 0], [3, -3, 0], [3, 3, 0], [-3, 3, 0]])
    corners[:, 2] = slope * corners[:, 0]
    tilted = make_physics(BODY, 3, Scene({"slope": corners}), variation)
    start = standing(BODY, np.zeros((3, 3)))
    start.coordinates[:, 3:7] = [np.cos(half), 0.0, -np.sin(half), 0.0]
    start.coordinates[:, 2] /= np.cos(2.0 * half)
    settled, _ = stand(tilted, start, 50)
    after, _ = stand(tilted, settled, 100)
    moved = after.position[:, 0] - settled.position[:, 0]
    assert (moved[[0, 2]] < -0.35).all()
    assert abs(moved[1]) < 0.2


def test_a_scene_is_boxes_and_meshes_and_no_height_field() -> None:
    step = np.array([[0.5, -1.0, 0.1], [2.0, -1, 0.1], [2.0, 1, 0.1], [0.5, 1, 0.1]])
    turned = np.array([[3.0, -1.0, 0.1], [4.0, 0.0, 0.1], [3.0, 1.0, 0.1], [2.0, 0.0, 0.1]])
    floor = np.array([[-2.0, -2.0, 0.0], [0.5, -2, 0], [0.5, 2, 0], [-2, 2, 0]])
    # One surface has the name of a geom of the robot's.
    scene = Scene({"LF_FOOT": floor, "step": step, "turned": turned})
    physics = make_physics(BODY, 2, scene)
    kinds = import_mujoco().MjModel.from_xml_string(physics.mjcf)
    assert kinds.nhfield == 0
    assert kinds.nmesh == 1
    places = np.array([[-1.0, 0.0, 0.0], [1.25, 0.0, 0.1]])
    after, _ = stand(physics, standing(BODY, places), 150)
    np.testing.assert_allclose(after.position[:, 2] - places[:, 2], 0.478, atol=0.005)


def test_what_does_not_fit_is_refused() -> None:
    with pytest.raises(InputError, match="a variation of 2 robots is given for 3 robots"):
        make_physics(BODY, 3, variation=Variation(np.ones(2), np.ones(2)))
    with pytest.raises(InputError, match="must be positive numbers"):
        Variation(np.ones(2), np.array([1.0, 0.0]))
    with pytest.raises(InputError, match=r"torques of shape \(1, 12\) and 1 states"):
        make_physics(BODY, 2).step(standing(BODY, np.zeros((1, 3))), np.zeros((1, 12)))


def test_without_mujoco_the_message_names_the_extra() -> None:
    code = (
        "import sys; sys.modules['mujoco'] = None\n"
        "from jaxleas.physics import load_body\n"
        "try:\n    load_body('anymal_b')\n"
        "except Exception as error:\n    print(type(error).__name__, error)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert "NoPhysicsError" in done.stdout
    assert "pip install 'jaxleas[physics]'" in done.stdout
