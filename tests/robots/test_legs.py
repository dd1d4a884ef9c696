import json
from dataclasses import replace

import numpy as np
import pytest
from urdfs import TALOS, published

from jaxleas.contacts.posture_model import about
from jaxleas.geometry import Box, Polytope
from jaxleas.robots import load_talos, read_robot, write_robot
from jaxleas.robots.legs import leg_angles, leg_posture, legs_of, load_talos_legs, mass_moment
from jaxleas.robots.spherical_leg import SphericalLeg
from jaxleas.types import InputError
from jaxleas.types.poses import Pose


@pytest.fixture
def legs():
    return load_talos_legs()


def draw(legs, count: int, seed: int) -> np.ndarray:
    return np.random.default_rng(seed).uniform(legs.lower, legs.upper, (count, 6))


def test_the_reference_stands_where_the_robot_facts_say(legs):
    posture = leg_posture(legs, legs.reference)
    np.testing.assert_allclose(posture.tip, [0.0, 0.0848, -1.0193], atol=1e-2)
    np.testing.assert_allclose(posture.tip_rotation[:, 2], [0.0, 0.0, 1.0], atol=5e-3)
    assert abs(legs.mass - load_talos().mass) < 0.01


def test_both_legs_agree_with_the_published_model(legs):
    pin = pytest.importorskip("pinocchio")
    model = pin.buildModelFromUrdf(str(published(TALOS)))
    data = model.createData()
    for limb, side, sign in zip(load_talos().limbs, ("left", "right"), (1.0, -1.0), strict=True):
        ids = [model.getJointId(f"leg_{side}_{number}_joint") for number in range(1, 7)]
        mirror = np.array([1.0, sign, 1.0])
        for angles in draw(legs, 30, seed=1):
            own = angles if sign > 0 else angles * legs.mirror_signs
            whole = pin.neutral(model)
            for joint, angle in zip(ids, own, strict=True):
                whole[model.joints[joint].idx_q] = angle
            pin.forwardKinematics(model, data, whole)
            sole = data.oMi[ids[-1]] * limb.effector.frame.position
            np.testing.assert_allclose(limb.model.posture(own).tip, sole, atol=1e-12)
            posture = leg_posture(legs, angles)
            np.testing.assert_allclose(mirror * posture.tip, sole, atol=1e-12)
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
    hip = legs.left.chain.positions[0]
    seen = np.einsum("nkj,nk->nj", posture.tip_rotation, hip - posture.origins[:, 5])
    above = seen[:, 2] > 0.0  # of two solutions the closed form takes this one
    found, reachable = leg_angles(legs, posture.tip, posture.tip_rotation)
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
    np.testing.assert_allclose(posture.tip, soles[reachable], atol=1e-9)
    np.testing.assert_allclose(posture.tip_rotation, level[reachable], atol=1e-9)
    assert (angles[reachable] >= legs.lower).all()
    assert (angles[reachable] <= legs.upper).all()
    shape = SphericalLeg.of(legs.left.chain)
    far = (
        np.linalg.norm(soles + np.array([0.0, 0.0, shape.sole]) - shape.hip, axis=1)
        > shape.thigh + shape.shank
    )
    assert not reachable[far].any()


def test_one_posture_or_any_batch(legs):
    angles = draw(legs, 6, seed=4)
    one = leg_posture(legs, angles[2])
    many = leg_posture(legs, angles.reshape(2, 3, 6))
    np.testing.assert_allclose(many.tip[0, 2], one.tip)
    found, _ = leg_angles(legs, many.tip, many.tip_rotation)
    np.testing.assert_allclose(found[0, 2], leg_angles(legs, one.tip, one.tip_rotation)[0])


def test_legs_survive_their_file(legs, tmp_path):
    write_robot(tmp_path / "robot.json", load_talos())
    described = json.loads((tmp_path / "robot.json").read_text())
    assert described["limbs"][1]["mirror_of"] == "left"
    again = legs_of(read_robot(tmp_path / "robot.json"))
    assert again.mass == legs.mass
    assert again.left.boxes == legs.left.boxes
    assert again.left.capsules == legs.left.capsules
    angles = draw(legs, 10, seed=5)
    np.testing.assert_array_equal(leg_posture(again, angles).tip, leg_posture(legs, angles).tip)


def test_legs_that_are_no_mirror_images_are_refused(legs):
    talos = load_talos()
    left, right = talos.limbs
    crossed = replace(talos, limbs=(left, replace(right, model=left.model)))
    with pytest.raises(InputError, match="2 legs that are not two mirror images"):
        legs_of(crossed)
    with pytest.raises(InputError, match=r"no 'body', or a leg of it no 'model'"):
        legs_of(replace(talos, body=None))
    with pytest.raises(InputError, match="has 1 legs; this planner moves two"):
        legs_of(replace(talos, limbs=(left,)))


def changed_chain(model, **changes):
    return replace(model, chain=replace(model.chain, **changes))


def with_first(sequence, **changes):
    first, *rest = sequence
    return (replace(first, **changes), *rest)


def turned_tip(model):
    tip = model.chain.tip
    return Pose.from_matrix(tip.position, about("z", 0.1) @ tip.rotation)


MODELS_THAT_DIFFER = {
    "number of joints": lambda m: replace(
        m,
        chain=replace(
            m.chain,
            **{key: getattr(m.chain, key)[:5] for key in ("names", "positions", "rotations")},
            **{key: getattr(m.chain, key)[:5] for key in ("axes", "lower", "upper")},
        ),
        **{key: getattr(m, key)[:5] for key in ("reference", "link_mass", "link_com")},
        boxes=(),
        capsules=(),
        starts=None,
    ),
    "joint positions": lambda m: changed_chain(m, positions=m.chain.positions + 0.01),
    "joint rotations": lambda m: changed_chain(m, rotations=about("x", 0.1) @ m.chain.rotations),
    "joint axes": lambda m: changed_chain(m, axes=-m.chain.axes),
    "lower joint limits": lambda m: changed_chain(m, lower=m.chain.lower - 0.1),
    "upper joint limits": lambda m: changed_chain(m, upper=m.chain.upper + 0.1),
    "position of the sole": lambda m: changed_chain(
        m, tip=Pose(m.chain.tip.position - [0.0, 0.0, 0.02], m.chain.tip.quaternion)
    ),
    "rotation of the sole": lambda m: changed_chain(m, tip=turned_tip(m)),
    "reference angles": lambda m: replace(m, reference=m.reference + 0.05),
    "masses": lambda m: replace(m, link_mass=2.0 * m.link_mass),
    "centres of mass": lambda m: replace(m, link_com=m.link_com + 0.02),
    "boxes": lambda m: replace(
        m, boxes=with_first(m.boxes, box=Box((-0.2, -0.2, -0.2), (0.2, 0.2, 0.2)))
    ),
    "capsules": lambda m: replace(m, capsules=with_first(m.capsules, radius=0.2)),
    "reach of the centre of mass": lambda m: replace(
        m, com_reach=Polytope(m.com_reach.normals, m.com_reach.offsets - 0.05)
    ),
}


@pytest.mark.parametrize("field", MODELS_THAT_DIFFER)
def test_legs_that_differ_in_anything_are_no_mirror_images(field: str) -> None:
    talos = load_talos()
    left, right = talos.limbs
    other = replace(right, model=MODELS_THAT_DIFFER[field](right.model))
    with pytest.raises(InputError, match=f"they differ in .*{field}"):
        legs_of(replace(talos, limbs=(left, other)))


@pytest.mark.parametrize(
    ("field", "change"),
    [
        ("half sizes of the soles", {"half_size": (0.05, 0.06)}),
        ("friction", {"friction": 0.2}),
    ],
)
def test_feet_that_differ_in_anything_are_no_mirror_images(field: str, change: dict) -> None:
    talos = load_talos()
    left, right = talos.limbs
    other = replace(right, effector=replace(right.effector, **change))
    with pytest.raises(InputError, match=f"they differ in {field}"):
        legs_of(replace(talos, limbs=(left, other)))


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda model: model.pop("joints"), "'joints'"),
        (lambda model: model["joints"][2].update(axis=[0, 0, 2]), "length 1"),
        (lambda model: model["joints"][2].update(lower=9.0), "its lower limit 9.0 is above"),
        (lambda model: model["joints"][2].update(mass=-1.0), "must not be negative"),
        (lambda model: model["joints"][2].pop("reference"), "'reference'"),
        (lambda model: model["boxes"][0].update(link=6), "no link 6"),
        (lambda model: model["tip"].update(quaternion=[1, 1, 0, 0]), "length 1"),
        (lambda model: model["com_reach"].update(offsets=[1.0]), "polytope"),
    ],
)
def test_a_damaged_model_is_refused_with_what_is_wrong(tmp_path, change, said):
    path = tmp_path / "robot.json"
    write_robot(path, load_talos())
    described = json.loads(path.read_text())
    change(described["limbs"][0]["model"])
    path.write_text(json.dumps(described))
    with pytest.raises(InputError, match=said):
        read_robot(path)


def test_a_mirror_image_of_nothing_is_refused(tmp_path):
    path = tmp_path / "robot.json"
    write_robot(path, load_talos())
    described = json.loads(path.read_text())
    described["limbs"][1]["mirror_of"] = "middle"
    path.write_text(json.dumps(described))
    with pytest.raises(InputError, match="no limb 'middle' with a 'model' comes before"):
        read_robot(path)


def test_a_box_and_a_polytope_are_mirrored_with_their_limb(legs):
    image = legs.left.mirrored()
    box, mirrored = legs.left.boxes[0].box, image.boxes[0].box
    assert (mirrored.low[1], mirrored.high[1]) == (-box.high[1], -box.low[1])
    point = np.array([0.2, 0.1, 0.7])
    assert isinstance(image.com_reach, Polytope)
    assert image.com_reach.contains(point * [1, -1, 1]) == legs.com_in_foot.contains(point)
