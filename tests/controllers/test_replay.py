"""States and torques of a walk are enough to make it again in plain MuJoCo, to the bit."""

import numpy as np

from jaxleas.controllers import Walk, find_controller
from jaxleas.physics import import_mujoco, load_body, make_physics, standing


def test_a_noisy_walk_is_replayed_by_plain_mujoco() -> None:
    mujoco, body = import_mujoco(), load_body("anymal_b")
    walk = Walk(make_physics(body, 1), find_controller("trot", body), noise=2.0)
    walking = walk.begin(standing(body, np.zeros((1, 3))))
    model = mujoco.MjModel.from_xml_string(walk.physics.mjcf)
    data, rng = mujoco.MjData(model), np.random.default_rng(0)
    data.qpos[:], data.qvel[:] = walking.state.coordinates[0], walking.state.speeds[0]
    for _ in range(120):
        ticked = walk.tick(walking, np.array([[0.5, 0.0, 0.2]]), rng)
        walking = ticked.walking
        data.qacc_warmstart[:] = 0.0  # each tick begins with a cold solver
        for state in ticked.stepped.states:
            data.ctrl[:] = ticked.torques[0]
            mujoco.mj_step(model, data)
            np.testing.assert_array_equal(data.qpos, state.coordinates[0])
            np.testing.assert_array_equal(data.qvel, state.speeds[0])
    assert data.qpos[0] > 0.05
