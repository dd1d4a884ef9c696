import json
from dataclasses import replace

import numpy as np
import pytest
from urdfs import TALOS, published

from jaxleas.contacts.posture_limbs import about
from jaxleas.geometry import Box, Polytope
from jaxleas.robots import Robot, load_talos, read_robot, write_robot
from jaxleas.robots.leg_kinds import same_model
from jaxleas.robots.legs import legs_of
from jaxleas.robots.spherical_leg import SphericalLeg
from jaxleas.types import InputError
from jaxleas.types.poses import Pose


@pytest.fixture
def left():
    """Return the model of the left leg of Talos."""
    return load_talos().limbs[0].model


def draw(model, count: int, seed: int) -> np.ndarray:
    return np.random.default_rng(seed).uniform(model.chain.lower, model.chain.upper, (count, 6))


def test_the_reference_stands_where_the_robot_facts_say(left):
    posture = left.posture(left.reference)
    np.testing.assert_allclose(posture.tip, [0.0, 0.0848, -1.0193], atol=1e-2)
    np.testing.assert_allclose(posture.tip_rotation[:, 2], [0.0, 0.0, 1.0], atol=5e-3)
    assert abs(legs_of(load_talos()).mass - load_talos().mass) < 0.01


def test_both_legs_agree_with_the_published_model(left):
    pin = pytest.importorskip("pinocchio")
    model = pin.buildModelFromUrdf(str(published(TALOS)))
    data = model.createData()
    for limb, side, sign in zip(load_talos().limbs, ("left", "right"), (1.0, -1.0), strict=True):
        ids = [model.getJointId(f"leg_{side}_{number}_joint") for number in range(1, 7)]
        mirror = np.array([1.0, sign, 1.0])
        for angles in draw(left, 30, seed=1):
            own = angles if sign > 0 else angles * left.chain.mirror_signs
            whole = pin.neutral(model)
            for joint, angle in zip(ids, own, strict=True):
                whole[model.joints[joint].idx_q] = angle
            pin.forwardKinematics(model, data, whole)
            sole = data.oMi[ids[-1]] * limb.effector.frame.position
            np.testing.assert_allclose(limb.model.posture(own).tip, sole, atol=1e-12)
            posture = left.posture(angles)
            np.testing.assert_allclose(mirror * posture.tip, sole, atol=1e-12)
            moment = sum(
                model.inertias[joint].mass * (data.oMi[joint] * model.inertias[joint].lever)
                for joint in ids
            )
            ours = mirror * left.mass_moment(posture.frames, posture.origins)
            np.testing.assert_allclose(
                ours, moment, atol=5e-3
            )  # the right leg is no exact mirror image


def test_inverse_undoes_forward_wherever_the_hip_is_above_the_foot(left):
    angles = draw(left, 5000, seed=2)
    posture = left.posture(angles)
    hip = left.chain.positions[0]
    seen = np.einsum("nkj,nk->nj", posture.tip_rotation, hip - posture.origins[:, 5])
    above = seen[:, 2] > 0.0  # of two solutions the closed form takes this one
    found, reachable = left.inverse(posture.tip, posture.tip_rotation)
    assert above.mean() > 0.9
    assert reachable[above].mean() > 0.99
    good = above & reachable
    np.testing.assert_allclose(found[good], angles[good], atol=1e-6)


def test_what_is_called_reachable_is_reached_within_the_limits(left):
    rng = np.random.default_rng(3)
    soles = rng.uniform([-0.8, -0.4, -1.2], [0.8, 0.7, -0.3], (4000, 3))
    level = np.broadcast_to(np.eye(3), (4000, 3, 3))
    angles, reachable = left.inverse(soles, level)
    assert 0.05 < reachable.mean() < 0.95
    posture = left.posture(angles[reachable])
    np.testing.assert_allclose(posture.tip, soles[reachable], atol=1e-9)
    np.testing.assert_allclose(posture.tip_rotation, level[reachable], atol=1e-9)
    assert (angles[reachable] >= left.chain.lower).all()
    assert (angles[reachable] <= left.chain.upper).all()
    shape = SphericalLeg.of(left.chain)
    far = (
        np.linalg.norm(soles + np.array([0.0, 0.0, shape.sole]) - shape.hip, axis=1)
        > shape.thigh + shape.shank
    )
    assert not reachable[far].any()


def test_one_posture_or_any_batch(left):
    angles = draw(left, 6, seed=4)
    one = left.posture(angles[2])
    many = left.posture(angles.reshape(2, 3, 6))
    np.testing.assert_allclose(many.tip[0, 2], one.tip)
    found, _ = left.inverse(many.tip, many.tip_rotation)
    np.testing.assert_allclose(found[0, 2], left.inverse(one.tip, one.tip_rotation)[0])


def test_legs_survive_their_file(left, tmp_path):
    write_robot(tmp_path / "robot.json", load_talos())
    described = json.loads((tmp_path / "robot.json").read_text())
    assert described["limbs"][1]["mirror_of"] == "left"
    read = legs_of(read_robot(tmp_path / "robot.json"))
    assert read.mass == legs_of(load_talos()).mass
    (again,) = read.models
    assert again.boxes == left.boxes
    assert again.capsules == left.capsules
    angles = draw(left, 10, seed=5)
    np.testing.assert_array_equal(again.posture(angles).tip, left.posture(angles).tip)


def test_a_robot_without_what_its_legs_need_is_refused(left):
    talos = load_talos()
    with pytest.raises(InputError, match=r"no 'body', or a leg of it no 'model'"):
        legs_of(replace(talos, body=None))
    with pytest.raises(InputError, match="has 1 feet; a planner that moves one foot at a time"):
        legs_of(replace(talos, limbs=talos.limbs[:1]))


def points(robot: Robot, *names: str) -> Robot:
    """Return a robot some of whose feet are points."""
    limbs = [
        replace(limb, effector=replace(limb.effector, kind="point_foot", half_size=(0.0, 0.0)))
        if limb.name in names
        else limb
        for limb in robot.limbs
    ]
    return replace(robot, limbs=tuple(limbs))


def test_a_robot_that_would_stand_on_points_that_span_no_area_is_refused():
    talos = load_talos()
    with pytest.raises(InputError, match="stand on 1 points alone while RF moves"):
        legs_of(points(talos, "left"))
    third = replace(talos.limbs[0], name="third", effector=replace(talos.effectors[0], name="T"))
    three = replace(talos, limbs=(*talos.limbs, third))
    assert len(legs_of(points(three, "left"))) == 3
    with pytest.raises(InputError, match="stand on 2 points alone while T moves"):
        legs_of(points(three, "left", "right"))


def test_a_sole_needs_six_joints():
    talos = load_talos()
    left, right = talos.limbs
    short = replace(right, model=DIFFERENT["number of joints"](right.model))
    with pytest.raises(InputError, match="the leg of RF has 5 joints, which cannot lay a sole"):
        legs_of(replace(talos, limbs=(left, short)))


def test_legs_that_are_mirror_images_share_a_model(left):
    legs = legs_of(load_talos())
    assert legs.models == (left,)
    np.testing.assert_array_equal(legs.side, [1.0, -1.0])
    np.testing.assert_array_equal(legs.others, [[1], [0]])
    same = replace(load_talos().limbs[0], name="other", effector=load_talos().effectors[1])
    twice = legs_of(replace(load_talos(), limbs=(load_talos().limbs[0], same)))
    assert twice.models == (left,)
    np.testing.assert_array_equal(twice.side, [1.0, 1.0])


def changed_chain(model, **changes):
    return replace(model, chain=replace(model.chain, **changes))


def with_first(sequence, **changes):
    first, *rest = sequence
    return (replace(first, **changes), *rest)


def turned_tip(model):
    tip = model.chain.tip
    return Pose.from_matrix(tip.position, about("z", 0.1) @ tip.rotation)


DIFFERENT = {
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


@pytest.mark.parametrize("field", DIFFERENT)
def test_a_leg_that_differs_in_anything_has_a_model_of_its_own(field: str) -> None:
    left, right = load_talos().limbs
    other = DIFFERENT[field](right.model)
    assert same_model(right.model, left.model.mirrored())
    assert not same_model(other, left.model.mirrored())
    if field != "number of joints":  # which a sole cannot do with
        legs = legs_of(replace(load_talos(), limbs=(left, replace(right, model=other))))
        assert legs.models == (left.model, other)
        np.testing.assert_array_equal(legs.side, [1.0, 1.0])


@pytest.mark.parametrize(
    ("change", "read", "expected"),
    [
        (
            {"half_size": (0.05, 0.06)},
            lambda legs: legs.corners[:, 0].tolist(),
            [[0.1, 0.06], [0.05, 0.06]],
        ),
        ({"friction": 0.2}, lambda legs: legs.friction.tolist(), [0.5, 0.2]),
    ],
)
def test_each_foot_has_its_own_sole_and_friction(change: dict, read, expected: list) -> None:
    left, right = load_talos().limbs
    other = replace(right, effector=replace(right.effector, **change))
    assert read(legs_of(replace(load_talos(), limbs=(left, other)))) == expected


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


def test_a_box_and_a_polytope_are_mirrored_with_their_limb(left):
    image = left.mirrored()
    box, mirrored = left.boxes[0].box, image.boxes[0].box
    assert (mirrored.low[1], mirrored.high[1]) == (-box.high[1], -box.low[1])
    point = np.array([0.2, 0.1, 0.7])
    assert isinstance(image.com_reach, Polytope)
    assert image.com_reach.contains(point * [1, -1, 1]) == left.com_reach.contains(point)
