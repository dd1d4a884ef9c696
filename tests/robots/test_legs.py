import json
import site
from pathlib import Path

import numpy as np
import pytest

from jaxleas.robots import load_talos
from jaxleas.robots.leg_kinematics import leg_angles, leg_posture, mass_moment
from jaxleas.robots.legs import MIRRORED_JOINTS, load_talos_legs, read_legs
from jaxleas.types import InputError

SOLE = np.array([0.0, 0.0, -0.107])


@pytest.fixture
def legs():
    return load_talos_legs()


def draw(legs, count: int, seed: int) -> np.ndarray:
    return np.random.default_rng(seed).uniform(legs.lower, legs.upper, (count, 6))


def test_the_reference_stands_where_the_robot_facts_say(legs):
    posture = leg_posture(legs, legs.reference)
    np.testing.assert_allclose(posture.sole, [0.0, 0.0848, -1.0193], atol=1e-2)
    np.testing.assert_allclose(posture.foot[:, 2], [0.0, 0.0, 1.0], atol=5e-3)
    assert abs(legs.mass - load_talos().mass) < 0.01


def test_both_legs_agree_with_the_published_model(legs):
    pin = pytest.importorskip("pinocchio")
    inside = "cmeel.prefix/share/example-robot-data/robots/talos_data/robots/talos_reduced.urdf"
    found = [Path(folder) / inside for folder in site.getsitepackages()]
    urdf = next((path for path in found if path.is_file()), None)
    if urdf is None:
        pytest.skip("example-robot-data is not installed")
    model = pin.buildModelFromUrdf(str(urdf))
    data = model.createData()
    for side, sign in (("left", 1.0), ("right", -1.0)):
        ids = [model.getJointId(f"leg_{side}_{number}_joint") for number in range(1, 7)]
        mirror = np.array([1.0, sign, 1.0])
        for angles in draw(legs, 30, seed=1):
            whole = pin.neutral(model)
            for joint, angle, flip in zip(ids, angles, MIRRORED_JOINTS, strict=True):
                whole[model.joints[joint].idx_q] = angle * (1.0 if sign > 0 else flip)
            pin.forwardKinematics(model, data, whole)
            posture = leg_posture(legs, angles)
            np.testing.assert_allclose(mirror * posture.sole, data.oMi[ids[-1]] * SOLE, atol=1e-6)
            moment = sum(
                model.inertias[joint].mass * (data.oMi[joint] * model.inertias[joint].lever)
                for joint in ids
            )
            ours = mirror * mass_moment(legs, posture.frames, posture.origins)
            np.testing.assert_allclose(
                ours, moment, atol=5e-3
            )  # the right leg is no exact mirror image


def test_inverse_undoes_forward_wherever_the_hip_is_above_the_foot(legs):
    angles = draw(legs, 5000, seed=2)
    posture = leg_posture(legs, angles)
    seen = np.einsum("nkj,nk->nj", posture.foot, legs.hip - posture.origins[:, 5])
    above = seen[:, 2] > 0.0  # of two solutions the closed form takes this one
    found, reachable = leg_angles(legs, posture.sole, posture.foot)
    assert above.mean() > 0.9
    assert reachable[above].mean() > 0.99
    good = above & reachable
    np.testing.assert_allclose(found[good], angles[good], atol=1e-6)


def test_what_is_called_reachable_is_reached_within_the_limits(legs):
    rng = np.random.default_rng(3)
    soles = rng.uniform([-0.8, -0.4, -1.2], [0.8, 0.7, -0.3], (4000, 3))
    level = np.broadcast_to(np.eye(3), (4000, 3, 3))
    angles, reachable = leg_angles(legs, soles, level)
    assert 0.05 < reachable.mean() < 0.95
    posture = leg_posture(legs, angles[reachable])
    np.testing.assert_allclose(posture.sole, soles[reachable], atol=1e-9)
    np.testing.assert_allclose(posture.foot, level[reachable], atol=1e-9)
    assert (angles[reachable] >= legs.lower).all()
    assert (angles[reachable] <= legs.upper).all()
    far = (
        np.linalg.norm(soles + np.array([0.0, 0.0, legs.sole]) - legs.hip, axis=1)
        > legs.thigh + legs.shank
    )
    assert not reachable[far].any()


def test_one_posture_or_any_batch(legs):
    angles = draw(legs, 6, seed=4)
    one = leg_posture(legs, angles[2])
    many = leg_posture(legs, angles.reshape(2, 3, 6))
    np.testing.assert_allclose(many.sole[0, 2], one.sole)
    found, _ = leg_angles(legs, many.sole, many.foot)
    np.testing.assert_allclose(found[0, 2], leg_angles(legs, one.sole, one.foot)[0])


def test_a_file_that_is_no_leg_model_is_named(tmp_path):
    path = tmp_path / "legs.json"
    path.write_text(json.dumps({"hip": [0, 0, 0]}))
    with pytest.raises(InputError, match=r"legs\.json lacks the key 'thigh'"):
        read_legs(path)
    path.write_text(json.dumps({"hip": [0, 0]}))
    with pytest.raises(InputError, match="does not describe legs"):
        read_legs(path)
