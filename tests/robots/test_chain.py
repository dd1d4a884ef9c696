from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from urdfs import G1, PANDA, TALOS, published

from jaxleas.robots import read_chain, rotation_of_rpy
from jaxleas.robots.chain import SerialChain, chain_jacobian, chain_posture
from jaxleas.types import InputError, Pose

LIMBS = [
    (TALOS, "base_link", "leg_left_6_link"),
    (TALOS, "base_link", "leg_right_6_link"),
    (G1, "pelvis", "left_ankle_roll_link"),
    (G1, "pelvis", "right_ankle_roll_link"),
    (G1, "pelvis", "left_rubber_hand"),  # ten joints, the waist's included, then a fixed one
    (PANDA, "panda_link0", "panda_hand"),
]


def toy(count: int, seed: int) -> SerialChain:
    """Return a chain whose frames and axes point anywhere."""
    rng = np.random.default_rng(seed)
    axes = rng.normal(size=(count, 3))
    return SerialChain(
        tuple(f"joint_{index}" for index in range(count)),
        rng.uniform(-0.3, 0.3, (count, 3)),
        Rotation.random(count, random_state=seed).as_matrix(),
        axes / np.linalg.norm(axes, axis=1, keepdims=True),
        rng.uniform(-2.0, -0.1, count),
        rng.uniform(0.1, 2.0, count),
        Pose.from_matrix(rng.uniform(-0.3, 0.3, 3), Rotation.random(random_state=9).as_matrix()),
    )


def draw(chain: SerialChain, count: int) -> np.ndarray:
    return np.random.default_rng(1).uniform(chain.lower, chain.upper, (count, len(chain)))


@pytest.mark.parametrize(("urdf", "root", "link"), LIMBS)
def test_kinematics_are_those_of_pinocchio(urdf: str, root: str, link: str) -> None:
    pin = pytest.importorskip("pinocchio")
    path = published(urdf)
    frame = Pose.from_yaw(np.array([0.02, -0.01, 0.05]), 0.3)
    chain = read_chain(path, root, link, frame)
    model = pin.buildModelFromUrdf(str(path))
    data, base, tip = model.createData(), model.getFrameId(root), model.getFrameId(link)
    joints = [model.joints[model.getJointId(name)].idx_q for name in chain.names]
    np.testing.assert_allclose(chain.lower, model.lowerPositionLimit[joints])
    np.testing.assert_allclose(chain.upper, model.upperPositionLimit[joints])
    angles = draw(chain, 30)
    posture = chain_posture(chain, angles)
    jacobian = chain_jacobian(chain, posture)
    placed = pin.SE3(frame.rotation, frame.position)
    for index, some in enumerate(angles):
        whole = pin.neutral(model)
        whole[joints] = some
        pin.framesForwardKinematics(model, data, whole)
        pin.computeJointJacobians(model, data, whole)
        seen = data.oMf[base].inverse() * data.oMf[tip] * placed
        np.testing.assert_allclose(posture.tip[index], seen.translation, atol=1e-12)
        np.testing.assert_allclose(posture.tip_rotation[index], seen.rotation, atol=1e-12)
        for joint, name in enumerate(chain.names):
            where = data.oMf[base].inverse() * data.oMi[model.getJointId(name)]
            np.testing.assert_allclose(posture.frames[index, joint], where.rotation, atol=1e-12)
            np.testing.assert_allclose(posture.origins[index, joint], where.translation, atol=1e-12)
        last, place = model.frames[tip].parentJoint, model.frames[tip].placement * placed
        aligned = pin.LOCAL_WORLD_ALIGNED
        speeds = pin.getFrameJacobian(model, data, last, place, aligned)[:, joints]
        turn = data.oMf[base].rotation.T
        np.testing.assert_allclose(jacobian[index, :3], turn @ speeds[:3], atol=1e-12)
        np.testing.assert_allclose(jacobian[index, 3:], turn @ speeds[3:], atol=1e-12)


def test_the_jacobian_is_the_derivative_of_the_tip() -> None:
    chain, step = toy(5, 3), 1e-6
    angles = draw(chain, 20)
    jacobian = chain_jacobian(chain, chain_posture(chain, angles))
    for joint in range(5):
        one = chain_posture(chain, angles + step * np.eye(5)[joint])
        other = chain_posture(chain, angles - step * np.eye(5)[joint])
        np.testing.assert_allclose(
            jacobian[:, :3, joint], (one.tip - other.tip) / (2.0 * step), atol=1e-8
        )
        between = one.tip_rotation @ other.tip_rotation.transpose(0, 2, 1)
        turn = Rotation.from_matrix(between).as_rotvec()
        np.testing.assert_allclose(jacobian[:, 3:, joint], turn / (2.0 * step), atol=1e-8)


def test_one_posture_or_any_batch() -> None:
    chain = toy(4, 5)
    angles = draw(chain, 6)
    one, many = chain_posture(chain, angles[4]), chain_posture(chain, angles.reshape(2, 3, 4))
    np.testing.assert_array_equal(many.tip[1, 1], one.tip)
    np.testing.assert_array_equal(many.frames[1, 1], one.frames)


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_a_mirrored_chain_reaches_the_mirrored_pose(seed: int) -> None:
    chain = toy(6, seed)
    image, mirror = chain.mirrored(), np.diag([1.0, -1.0, 1.0])
    angles = draw(chain, 40)
    here, there = chain_posture(chain, angles), chain_posture(image, angles * chain.mirror_signs)
    np.testing.assert_allclose(there.tip, here.tip @ mirror, atol=1e-12)
    np.testing.assert_allclose(there.tip_rotation, mirror @ here.tip_rotation @ mirror, atol=1e-12)
    mirrored = angles * chain.mirror_signs
    assert ((mirrored >= image.lower) & (mirrored <= image.upper)).all()
    again = image.mirrored()
    np.testing.assert_allclose(again.axes, chain.axes, atol=1e-12)
    np.testing.assert_allclose(again.lower, chain.lower)


@pytest.mark.parametrize("urdf", [TALOS, G1])
def test_right_legs_are_the_left_ones_mirrored(urdf: str) -> None:
    path = published(urdf)
    links = {
        TALOS: ("base_link", "leg_{}_6_link"),
        G1: ("pelvis", "{}_ankle_roll_link"),
    }[urdf]
    left = read_chain(path, links[0], links[1].format("left")).mirrored()
    right = read_chain(path, links[0], links[1].format("right"))
    for key in ("positions", "rotations", "axes", "lower", "upper"):
        np.testing.assert_allclose(getattr(left, key), getattr(right, key), atol=1e-9)


def test_rpy_is_as_urdf_counts_it() -> None:
    roll, pitch, yaw = 0.3, -0.8, 2.1
    theirs = Rotation.from_euler("xyz", [roll, pitch, yaw]).as_matrix()
    np.testing.assert_allclose(rotation_of_rpy(roll, pitch, yaw), theirs, atol=1e-15)


URDF = """<robot name="toy">
  <link name="base"/><link name="arm"/><link name="hand"/>
  <joint name="slide" type="{kind}"><parent link="base"/><child link="arm"/>
    <origin xyz="0 0 {z}"/><axis xyz="{axis}"/><limit lower="-1" upper="1"/></joint>
  <joint name="wrist" type="fixed"><parent link="arm"/><child link="hand"/>
    <origin xyz="0.1 0 0"/><axis xyz="0 0 0"/></joint>
</robot>"""


def write(folder: Path, kind: str = "revolute", z: str = "0.5", axis: str = "0 0 1") -> Path:
    path = folder / "toy.urdf"
    path.write_text(URDF.format(kind=kind, z=z, axis=axis))
    return path


def test_fixed_joints_are_folded_in(tmp_path: Path) -> None:
    chain = read_chain(write(tmp_path), "base", "hand")
    assert chain.names == ("slide",)
    tip = chain_posture(chain, np.array([np.pi / 2])).tip
    np.testing.assert_allclose(tip, [0.0, 0.1, 0.5], atol=1e-15)
    free = read_chain(write(tmp_path, kind="continuous"), "base", "hand")
    np.testing.assert_allclose([free.lower[0], free.upper[0]], [-np.pi, np.pi])


@pytest.mark.parametrize(
    ("change", "link", "said"),
    [
        ({"kind": "prismatic"}, "hand", "joint 'slide' is prismatic; a limb's joints must be"),
        ({"axis": "0 0 0"}, "hand", "joint 'slide' is not one of a URDF: its axis is zero"),
        ({"z": "high"}, "hand", "joint 'slide' is not one of a URDF"),
        ({"z": "nan"}, "hand", "not three finite numbers"),
        ({}, "foot", "no chain of joints from link 'base' to link 'foot'"),
        ({}, "base", "no joint moves between"),
    ],
)
def test_what_is_no_limb_is_refused(tmp_path: Path, change: dict, link: str, said: str) -> None:
    with pytest.raises(InputError, match=said):
        read_chain(write(tmp_path, **change), "base", link)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("<robot", "is not a URDF"),
        ("<sdf/>", "needs a <robot> with joints"),
        ('<!DOCTYPE r [<!ENTITY a "b">]><robot/>', "declares a document type"),
    ],
)
def test_a_file_that_is_no_urdf_is_refused(tmp_path: Path, text: str, said: str) -> None:
    path = tmp_path / "toy.urdf"
    path.write_text(text)
    with pytest.raises(InputError, match=said):
        read_chain(path, "base", "hand")


def test_a_chain_with_crossed_limits_is_refused() -> None:
    good = toy(2, 0)
    with pytest.raises(InputError, match="joint 'joint_1': its lower limit"):
        SerialChain(
            good.names,
            good.positions,
            good.rotations,
            good.axes,
            good.lower,
            np.array([1.0, -3.0]),
            good.tip,
        )
