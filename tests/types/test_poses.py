import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from jaxleas.types import InputError, Pose, RootMotion, RootPose
from jaxleas.types.quaternions import matrix_of, multiply, quaternion_about_z, quaternion_of


def draw(count: int, seed: int) -> Pose:
    rng = np.random.default_rng(seed)
    quaternion = rng.normal(size=(count, 4))
    return Pose(
        rng.uniform(-2.0, 2.0, (count, 3)),
        quaternion / np.linalg.norm(quaternion, axis=1, keepdims=True),
    )


def require_same(one: Pose, other: Pose) -> None:
    np.testing.assert_allclose(one.position, other.position, atol=1e-12)
    np.testing.assert_allclose(one.rotation, other.rotation, atol=1e-12)


def test_poses_are_a_group():
    one, two, three = draw(50, 0), draw(50, 1), draw(50, 2)
    require_same((one @ two) @ three, one @ (two @ three))
    require_same(one @ one.inverse(), Pose(np.zeros((50, 3)), quaternion_about_z(np.zeros(50))))
    require_same((one @ two).inverse(), two.inverse() @ one.inverse())


def test_a_product_transforms_as_its_factors_one_after_the_other():
    one, two = draw(50, 0), draw(50, 1)
    points = np.random.default_rng(3).normal(size=(50, 7, 3))
    both = one.transform(two.transform(points))
    np.testing.assert_allclose((one @ two).transform(points), both, atol=1e-12)
    np.testing.assert_allclose(one.inverse().transform(one.transform(points)), points, atol=1e-12)


def test_matrices_agree_with_scipy():
    quaternion = draw(200, 4).quaternion
    theirs = Rotation.from_quat(quaternion, scalar_first=True)
    np.testing.assert_allclose(matrix_of(quaternion), theirs.as_matrix(), atol=1e-14)
    product = theirs[:100] * theirs[100:]
    ours = matrix_of(multiply(quaternion[:100], quaternion[100:]))
    np.testing.assert_allclose(ours, product.as_matrix(), atol=1e-14)


@pytest.mark.parametrize("near", [0.0, 1e-9, 1e-5])
def test_quaternions_of_matrices_survive_half_turns(near):
    axes = np.concatenate([np.eye(3), draw(60, 5).position])
    axes /= np.linalg.norm(axes, axis=1, keepdims=True)
    matrices = Rotation.from_rotvec(axes * (np.pi - near)).as_matrix()
    quaternions = quaternion_of(matrices)
    assert (quaternions[:, 0] >= 0.0).all()
    np.testing.assert_allclose(np.linalg.norm(quaternions, axis=1), 1.0, atol=1e-15)
    np.testing.assert_allclose(matrix_of(quaternions), matrices, atol=1e-12)


def test_an_upright_root_keeps_its_yaw():
    yaw = np.linspace(-3.1, 3.1, 21)
    position = np.random.default_rng(0).normal(size=(21, 3)).astype(np.float32)
    pose = RootPose.from_motion(RootMotion(position, np.zeros_like(position), yaw))
    np.testing.assert_allclose(pose.yaw, yaw, atol=1e-12)
    np.testing.assert_allclose(pose.rotation[:, :, 2], np.tile([0.0, 0.0, 1.0], (21, 1)))
    np.testing.assert_array_equal(pose.position, position)
    turned = pose @ Pose.from_yaw(np.zeros((21, 3)), -yaw)
    assert isinstance(turned, RootPose)
    np.testing.assert_allclose(turned.yaw, 0.0, atol=1e-12)


@pytest.mark.parametrize(
    ("position", "quaternion", "said"),
    [
        (np.zeros(3), np.array([1.0, 0.0, 0.0, 0.1]), "length 1"),
        (np.zeros(2), np.array([1.0, 0.0, 0.0, 0.0]), r"\(2,\)"),
        (np.zeros((2, 3)), np.array([1.0, 0.0, 0.0, 0.0]), "make no pose"),
        (np.array([0.0, np.nan, 0.0]), np.array([1.0, 0.0, 0.0, 0.0]), "finite"),
    ],
)
def test_what_is_no_pose_is_refused(position, quaternion, said):
    with pytest.raises(InputError, match=said):
        Pose(position, quaternion)
