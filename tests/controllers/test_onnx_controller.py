"""Policies in ONNX files as controllers: order, scales, gains, and files that are none."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import onnx
import pytest
from onnx import TensorProto, helper, numpy_helper

from jaxleas.controllers import UPRIGHT, Walk, falls, find_controller
from jaxleas.physics import load_body, make_physics, standing
from jaxleas.types import InputError, matrix_of

BODY = load_body("anymal_b")
RNG = np.random.default_rng(0)
BACKWARDS = list(BODY.joints[::-1])
DESCRIPTION: dict[str, Any] = {
    "version": 1,
    "robot": "anymal_b",
    "joints": BACKWARDS,
    "standing": BODY.standing[::-1].tolist(),
    "stiffness": 200.0,
    "damping": 8.0,
    "action_scale": 0.5,
    "period": 0.02,
    "observation": ["command", "velocity", "turning_rate", "gravity", "angles", "joint_speeds",
                    "last_action", "clock"],
    "pairs": [["LF", "RH"], ["RF", "LH"]],
    "swing_height": 0.065,
    "max_speeds": [1.0, 0.5, 1.0],
    "cycle": 0.6,
    "scales": {"joint_speeds": 0.05},
}  # fmt: skip
SIZE = 3 + 3 + 3 + 3 + 12 + 12 + 12 + 2


def policy(folder: Path, weights: np.ndarray, **changes: Any) -> str:
    """Write a policy, output = observation times weights, and its description."""
    nodes = [helper.make_node("MatMul", ["seen", "weights"], ["action"])]
    shapes = {"seen": ["N", weights.shape[0]], "action": ["N", weights.shape[1]]}
    seen, action = (
        helper.make_tensor_value_info(name, TensorProto.FLOAT, shape)
        for name, shape in shapes.items()
    )
    kept = [numpy_helper.from_array(weights.astype(np.float32), "weights")]
    graph = helper.make_graph(nodes, "policy", [seen], [action], kept)
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)], ir_version=9)
    onnx.save(model, folder / "walker.onnx")
    (folder / "walker.json").write_text(json.dumps(DESCRIPTION | changes))
    return str(folder / "walker.onnx")


def test_a_policy_that_does_nothing_stands(tmp_path: Path) -> None:
    controller = find_controller(policy(tmp_path, np.zeros((SIZE, 12))), BODY)
    assert controller.identity.name == "walker"
    assert controller.identity.pair_names == ("LF/RH", "RF/LH")
    assert len(str(controller.identity.settings["policy_sha256"])) == 64
    walk = Walk(make_physics(BODY, 2), controller)
    walking = walk.begin(standing(BODY, np.zeros((2, 3))))
    for _ in range(100):
        walking = walk.tick(walking, np.zeros((2, 3))).walking
    assert (falls(BODY, walking.state, walking.sensed) == UPRIGHT).all()
    np.testing.assert_allclose(walking.state.angles, np.tile(BODY.standing, (2, 1)), atol=0.1)


def test_numbers_go_in_and_out_in_the_order_and_scale_of_the_description(tmp_path: Path) -> None:
    weights = RNG.normal(0.0, 0.2, (SIZE, 12))
    controller = find_controller(policy(tmp_path, weights), BODY)
    state = standing(BODY, np.zeros((3, 3)), RNG.uniform(-3.0, 3.0, 3))
    state.coordinates[:, 7:] += RNG.normal(0.0, 0.1, (3, 12))
    state.speeds[:] = RNG.normal(0.0, 1.0, state.speeds.shape)
    memory = controller.start(state)
    state.time[:] += 0.15  # a quarter of a cycle
    sensed = make_physics(BODY, 3).step(state, np.zeros((3, 12))).sensed
    command = RNG.uniform(-1.0, 1.0, (3, 3))
    last = np.zeros(12)
    for _ in range(2):
        memory, wanted = controller.act(memory, state, sensed, command)
        for robot in range(3):
            world = matrix_of(state.quaternion)[robot]
            seen = [*command[robot], *(world.T @ state.velocity[robot])]
            seen += [*state.turning_rate[robot], *(world.T @ [0.0, 0.0, -1.0])]
            seen += [*(state.angles[robot] - BODY.standing)[::-1]]
            seen += [*(0.05 * state.joint_speeds[robot])[::-1], *last, 1.0, 0.0]
            action = np.array(seen) @ weights
            targets = BODY.standing + 0.5 * action[::-1]
            if robot == 0:
                np.testing.assert_allclose(wanted.targets[0], targets, atol=1e-4)
                torques = 200.0 * (targets - state.angles[0]) - 8.0 * state.joint_speeds[0]
                np.testing.assert_allclose(wanted.torques_at(state)[0], torques, atol=0.05)
                after = action
        last = after  # of robot 0, the only one compared


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"robot": "spot"}, "the policy walks spot, not anymal_b"),
        ({"joints": BACKWARDS[:-1]}, "joints must be those of anymal_b in any order"),
        ({"pairs": [["LF", "RH"]]}, "pairs must hold each of LF, RF, LH, RH once"),
        ({"cycle": 0.0}, "the observation has a clock; give its duration"),
        ({"period": 0.0}, "period must be positive"),
        ({"observation": ["lidar"]}, "is no description of a walking policy: observation"),
        ({"version": 2}, "version"),
    ],
)
def test_a_description_that_does_not_fit_is_refused(tmp_path: Path, changes, message) -> None:
    with pytest.raises(InputError, match=message):
        find_controller(policy(tmp_path, np.zeros((SIZE, 12)), **changes), BODY)


def test_files_that_are_no_policy_are_refused(tmp_path: Path) -> None:
    path = policy(tmp_path, np.zeros((SIZE, 11)))
    state = standing(BODY, np.zeros((1, 3)))
    sensed = make_physics(BODY, 1).step(state, np.zeros((1, 12))).sensed
    controller = find_controller(path, BODY)
    with pytest.raises(InputError, match=r"answers with \(1, 11\); \(1, 12\) is needed"):
        controller.act(controller.start(state), state, sensed, np.zeros((1, 3)))
    controller = find_controller(policy(tmp_path, np.zeros((5, 12))), BODY)
    with pytest.raises(InputError, match="cannot be run on observations of 50 numbers"):
        controller.act(controller.start(state), state, sensed, np.zeros((1, 3)))
    (tmp_path / "walker.onnx").write_bytes(b"not ONNX")
    with pytest.raises(InputError, match="is no ONNX policy"):
        find_controller(path, BODY)
    (tmp_path / "walker.json").unlink()
    with pytest.raises(InputError, match=r"walker\.json"):
        find_controller(path, BODY)
