import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from jaxleas.robots import (
    Effector,
    Limb,
    load_robot,
    load_talos,
    read_robot,
    robot_names,
    write_robot,
)
from jaxleas.robots.legs import legs_of
from jaxleas.types import InputError

ROOT = Path(__file__).parents[2]
POLYTOPES = ROOT.parent / "shared/data/talos-polytopes.json"


@pytest.fixture
def talos():
    return load_talos()


def test_talos_is_found_by_name_and_others_are_not(talos):
    assert load_robot("talos") is talos
    with pytest.raises(InputError, match=r"no robot 'Talo', only .*talos.*did you mean talos\?"):
        load_robot("Talo")


def test_robots_of_ones_own_are_found_by_name_and_by_path(talos, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    own = replace(talos, name="walker")
    Path("robots").mkdir()
    write_robot("robots/walker.json", own)
    write_robot("elsewhere.json", own)
    assert load_robot("walker").name == load_robot("elsewhere.json").name == "walker"
    with pytest.raises(InputError, match=r"only .*walker.*did you mean walker\?"):
        load_robot("walter")
    Path("robots/runner.json").write_bytes(Path("elsewhere.json").read_bytes())
    with pytest.raises(InputError, match=r"describes the robot 'walker'; name the file after it"):
        load_robot("runner")
    with pytest.raises(InputError, match=r"missing\.json"):
        load_robot("missing.json")


def test_legs_are_mirror_images(talos):
    left, right = (limb.range_of_motion for limb in talos.limbs)
    assert [limb.name for limb in talos.limbs] == ["left", "right"]
    points = np.random.default_rng(0).uniform((-0.5, -0.5, -1.2), (0.5, 0.5, -0.5), (5000, 3))
    inside = left.contains(points)
    assert inside.any()
    np.testing.assert_array_equal(inside, right.contains(points * np.array([1.0, -1.0, 1.0])))


def test_both_legs_stand_at_walking_and_at_reference_height(talos):
    for limb, side in zip(talos.limbs, (1, -1), strict=True):
        for height in (0.9, talos.walking_height, 0.98, talos.root_height):
            assert limb.range_of_motion.contains(np.array([0.0, side * 0.0848, -height]))


def test_under_the_root_legs_reach_from_a_crouch_to_nearly_stretched(talos):
    low, high = talos.limbs[0].range_of_motion.z_interval(np.array([[0.0, 0.085], [0.0, 0.0]]))
    assert np.all((low > -1.08) & (low < -1.05))
    assert np.all((high > -0.70) & (high < -0.628)), "a foot must not enter the trunk's box"


def test_the_range_is_near_the_published_reduced_set(talos):
    published = np.array([[-0.35, -0.07, -1.06], [0.35, 0.30, -0.65]])
    bounds = talos.limbs[0].range_of_motion.bounds
    np.testing.assert_allclose([bounds.low, bounds.high], published, atol=0.012)


def test_steps_published_as_feasible_start_and_end_in_reach(talos):
    # The published relative polytopes bound the right foot seen from the left one. With the left
    # foot at its reference and the root above, a level right foot in both sets must be reachable
    # often, though not always: the published set says nothing about where the root is.
    if not POLYTOPES.is_file():
        pytest.skip(f"{POLYTOPES} is not here")
    published = json.loads(POLYTOPES.read_text())["sets"]["talos_REDUCED"]["RF_in_LF"]
    rng = np.random.default_rng(0)
    steps = rng.uniform((-0.3, -0.35, -0.1), (0.3, -0.15, 0.1), (4000, 3))
    inside = np.all(steps @ np.array(published["A"]).T <= np.array(published["b"]), axis=1)
    assert inside.sum() > 500
    right_foot = np.array([0.0, 0.0848, -talos.walking_height]) + steps[inside]
    assert talos.limbs[1].range_of_motion.contains(right_foot).mean() > 0.9


def test_a_robot_survives_its_file(talos, tmp_path):
    write_robot(tmp_path / "robot.json", talos, about="a copy")
    again = read_robot(tmp_path / "robot.json")
    assert again.trunk == talos.trunk
    assert (again.mass, again.friction, again.root_height) == (90.272, 0.5, 1.0198)
    for one, other in zip(again.limbs, talos.limbs, strict=True):
        np.testing.assert_array_equal(one.range_of_motion.offsets, other.range_of_motion.offsets)
    for one, other in zip(again.effectors, talos.effectors, strict=True):
        assert (one.name, one.kind, one.half_size) == (other.name, other.kind, other.half_size)
        assert (one.friction, one.force_limit, one.link) == (0.5, None, other.link)
        np.testing.assert_array_equal(one.frame.position, [0.0, 0.0, -0.107])
    assert again.start_heights == talos.start_heights
    np.testing.assert_array_equal(again.references, talos.references)
    assert again.steps.keys() == {"RF_in_LF", "LF_in_RF", "COM_in_LF", "COM_in_RF"}
    for name, polytope in talos.steps.items():
        np.testing.assert_array_equal(again.steps[name].normals, polytope.normals)


def test_a_file_from_before_effectors_opens_with_feet_of_the_robots_size(talos, tmp_path):
    path = tmp_path / "robot.json"
    write_robot(path, talos)
    described = json.loads(path.read_text())
    for key in ("start_heights", "steps"):
        described.pop(key)
    for limb in described["limbs"]:
        limb.pop("effector")
        limb.pop("reference")
    described.update(foot_half_size=[0.11, 0.05], friction=0.7)
    path.write_text(json.dumps(described))
    read = read_robot(path)
    assert [effector.name for effector in read.effectors] == ["LF", "RF"]
    assert {each.kind for each in read.effectors} == {"foot"}
    assert {each.half_size for each in read.effectors} == {(0.11, 0.05)}
    assert {each.friction for each in read.effectors} == {0.7}
    assert read.start_heights == (-0.20, 0.07)
    assert not read.steps
    for place, limb in zip(read.references, read.limbs, strict=True):
        assert place[2] == -read.root_height
        assert limb.range_of_motion.contains([place[0], place[1], -read.walking_height])


def test_effectors_are_found_by_name(talos):
    assert talos.feet == (0, 1)
    assert talos.effector_index("RF") == 1
    assert talos.effector("LF").corners.shape == (4, 3)
    with pytest.raises(InputError, match=r"no effector 'LP'; perhaps you meant LF; it has LF, RF"):
        talos.effector("LP")


def test_palms_carry_no_walking_robot(talos):
    palm = Effector("LP", "palm", (0.05, 0.05), 0.5)
    arm = Limb("left_arm", talos.limbs[0].range_of_motion, palm)
    armed = replace(talos, limbs=(*talos.limbs, arm))
    assert armed.feet == (0, 1)
    assert armed.effector_index("LP") == 2
    middle = armed.references[2]
    assert arm.range_of_motion.contains(middle)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"kind": "hoof"}, "no known kind: 'hoof'; there are foot, palm, point_foot"),
        ({"half_size": (0.1, -0.1)}, "half length and half width"),
        ({"half_size": (0.0, 0.0)}, "point foot are 0"),
        ({"friction": 0.0}, "friction must be a positive number"),
        ({"force_limit": -1.0}, "force_limit must be a positive number"),
        ({"name": ""}, "needs a name"),
    ],
)
def test_what_is_no_effector_is_refused(talos, change, said):
    with pytest.raises(InputError, match=said):
        replace(talos.effectors[0], **change)


def test_two_effectors_of_one_name_are_refused(talos):
    with pytest.raises(InputError, match="two effectors called 'LF'"):
        replace(talos, limbs=(talos.limbs[0], replace(talos.limbs[0], name="other")))


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda robot: robot.pop("trunk"), "trunk"),
        (lambda robot: robot.update(limbs=[{"name": "left"}]), "normals"),
        (lambda robot: robot.update(mass="heavy"), "heavy"),
        (lambda robot: robot.update(foot_half_size=[1.0]), "robot"),
        (lambda robot: robot["limbs"][0].update(offsets=[1.0]), "polytope"),
        (lambda robot: robot["trunk"][0].update(low=[0, 0, 9]), "box"),
        (lambda robot: robot["limbs"][0]["effector"].update(kind="hoof"), "hoof"),
        (lambda robot: robot["limbs"][0]["effector"].pop("kind"), "'kind'"),
        (lambda robot: robot["limbs"][0]["effector"]["frame"].update(position=[1]), "pose"),
        (lambda robot: robot["limbs"][0].update(reference=[1, 2]), "robot"),
        (lambda robot: robot.update(steps=[1]), "robot"),
        (lambda robot: robot.update(start_heights=[0.1, -0.1]), "start_heights"),
    ],
)
def test_a_damaged_file_is_refused_with_what_is_wrong(talos, tmp_path, change, said):
    path = tmp_path / "robot.json"
    write_robot(path, talos)
    described = json.loads(path.read_text())
    change(described)
    path.write_text(json.dumps(described))
    with pytest.raises(InputError, match=said):
        read_robot(path)


@pytest.mark.parametrize("name", robot_names())
def test_shipped_files_are_small_and_stand_beside_their_options(name):
    shipped = ROOT / f"jaxleas/robots/data/{name}.json"
    assert shipped.stat().st_size < 100_000
    assert shipped.with_suffix(".yaml").is_file()
    assert load_robot(name).name == name


@pytest.mark.parametrize("name", robot_names())
def test_shipped_robots_stand_in_reach_of_everything_that_plans_for_them(name):
    robot = load_robot(name)
    legs = legs_of(robot)
    assert abs(legs.mass - robot.mass) < 0.01
    left, right = robot.references
    np.testing.assert_allclose(left, right * [1, -1, 1])
    assert robot.steps["RF_in_LF"].contains(right - left, 1e-3)
    com = reference_com(robot)
    for foot, place, limb in zip(("LF", "RF"), robot.references, robot.limbs, strict=True):
        np.testing.assert_allclose(limb.model.posture(limb.model.reference).tip, place, atol=0.01)
        assert robot.steps[f"COM_in_{foot}"].contains(com - place)
        assert limb.model.com_reach.contains(com - place)
        assert np.abs((com - place)[0]) < robot.foot_half_size[0], "it would fall over"
        for height in robot.start_heights:
            under = np.array([*place[:2], -robot.walking_height - height])
            assert limb.range_of_motion.contains(under)


def reference_com(robot) -> np.ndarray:
    moment, mass = robot.body.mass * robot.body.com, robot.body.mass
    for limb in robot.limbs:
        posture = limb.model.posture(limb.model.reference)
        moment = moment + limb.model.mass_moment(posture.frames, posture.origins)
        mass += limb.model.link_mass.sum()
    return moment / mass


@pytest.mark.parametrize("name", ["a" * 300, "ä" * 200, "a" * 300 + ".json", "a\0b", "../talos"])
def test_what_is_no_name_of_a_robot_is_refused(name):
    with pytest.raises(InputError):
        load_robot(name)
