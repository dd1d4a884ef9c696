"""`jaxleas robot make` on URDFs whose kinematics are known."""

import json

import numpy as np
import pytest

from jaxleas import cli
from jaxleas.conditions import collision, strict_reachability
from jaxleas.contacts import problem_from_guide
from jaxleas.contacts.programs.mip import plan_mip
from jaxleas.contacts.programs.sl1m import plan_sl1m
from jaxleas.contacts.search.astar import plan_astar
from jaxleas.envs.steering import SteeringConfig, SteeringEnv
from jaxleas.modelling.options import MakeOptions
from jaxleas.modelling.sampling import Standing, draw_standing
from jaxleas.modelling.sketch import sketch_robot
from jaxleas.modelling.twin import compare_with_pinocchio
from jaxleas.robots import legs_of, load_robot, read_robot
from tests.contacts.sampling.worlds import flat, straight

from . import urdfs

BEND = 0.4  # least bend of a knee [rad]
FEW = ["--samples", "40000"]


def make(*arguments: object) -> None:
    cli.run(["robot", "make", *map(str, arguments)])


@pytest.fixture(scope="module")
def stilts(tmp_path_factory):
    folder = tmp_path_factory.mktemp("stilts")
    options = folder / "stilts.yaml"
    options.write_text("reach: {back: 9, ahead: 9, outward: 9}\npairs: 4000\n")
    urdf = urdfs.stilts(folder / "stilts.urdf")
    out = folder / "robots/stilts.json"
    make(urdf, "--feet", "l_foot", "r_foot", "--options", options, "--out", out, *FEW)
    return urdf, out


def test_a_leg_reaches_a_shell_around_its_hip(stilts):
    """A thigh and a shank with a bent knee reach as far as the law of cosines says."""
    robot = read_robot(stilts[1])
    assert [each.kind for each in robot.effectors] == ["point_foot", "point_foot"]
    hip = np.array([0.0, urdfs.HIP, 0.0])
    longest = np.sqrt(
        urdfs.THIGH**2 + urdfs.SHANK**2 + 2.0 * urdfs.THIGH * urdfs.SHANK * np.cos(BEND)
    )
    polytope = robot.limbs[0].range_of_motion
    farthest = np.linalg.norm(polytope.vertices - hip, axis=1).max()
    assert farthest <= longest + 0.05, "corners of few faces stick out a little"
    assert -polytope.bounds.low[2] == pytest.approx(longest, abs=0.01)
    angles = np.linspace(-1.2, 0.5, 18)  # thigh and shank in one plane, the knee bent least
    below = hip - np.stack([np.sin(angles), 0 * angles, np.cos(angles)], axis=1) * (longest - 0.01)
    assert polytope.contains(below[below[:, 2] < -0.2]).all()
    # The trunk ends at the root: soles stay below by the clearance, and on their own side.
    assert polytope.bounds.high[2] == pytest.approx(-0.02, abs=0.01)
    assert polytope.bounds.low[1] == pytest.approx(0.0, abs=0.01)
    np.testing.assert_array_equal(
        robot.limbs[1].range_of_motion.offsets, polytope.mirrored().offsets
    )


def test_the_centre_of_mass_of_massless_legs_is_the_body_s(stilts):
    robot = read_robot(stilts[1])
    assert robot.mass == 20.0
    np.testing.assert_allclose(robot.body.com, [0.0, 0.0, 0.1])
    feet = robot.limbs[0].range_of_motion.vertices
    com = robot.steps["COM_in_LF"]
    low, high = np.array(com.bounds.low), np.array(com.bounds.high)
    assert (low >= [0.0, 0.0, 0.1] - feet.max(axis=0) - 0.01).all()
    assert (high <= [0.0, 0.0, 0.1] - feet.min(axis=0) + 0.01).all()
    step = robot.steps["RF_in_LF"]
    left, right = robot.references
    assert step.contains(right - left)
    assert step.bounds.high[0] == pytest.approx(0.32 * robot.root_height / 1.0198, abs=0.002)


def test_the_same_seed_makes_the_same_file_and_says_of_what(stilts, tmp_path):
    urdf, out = stilts
    options = out.parents[1] / "stilts.yaml"
    again = tmp_path / "stilts.json"
    make(urdf, "--feet", "l_foot", "r_foot", "--options", options, "--out", again, *FEW)
    assert again.read_bytes() == out.read_bytes()
    assert again.with_suffix(".png").stat().st_size > 10_000
    made = json.loads(again.read_text())["made"]
    assert made["urdf"] == "stilts.urdf"
    assert len(made["urdf_sha256"]) == 64
    assert made["options"]["seed"] == 0
    assert made["options"]["feet"] == ["l_foot", "r_foot"]


def test_another_seed_draws_others(stilts):
    sketch = sketch_robot(stilts[0], MakeOptions(feet=("l_foot", "r_foot")), print)
    leg = sketch.stance.legs[0]
    ground = Standing(None, -0.3, (-1.0, -1.0), (1.0, 1.0))
    one, other = (draw_standing(leg.chain, ground, 1000, seed, print).soles for seed in (0, 1))
    assert len(one) > 100
    assert one.shape != other.shape or not np.array_equal(one, other)


@pytest.fixture(scope="module")
def walker(tmp_path_factory):
    folder = tmp_path_factory.mktemp("walker")
    urdf = urdfs.walker(folder / "walker.urdf", sole="0.03 0 -0.06")
    make(urdf, "--feet", "r_sole", "l_sole", "--out", folder / "robots/walker.json", *FEW)
    return folder


def test_a_robot_steers_and_three_exact_planners_plan_for_it(walker, monkeypatch, capsys):
    monkeypatch.chdir(walker)
    robot = load_robot("walker")
    assert robot.foot_names == ("LF", "RF")
    assert robot.effectors[0].link == "l_sole", "feet are put left before right"
    assert robot.foot_half_size == (0.1, 0.05)
    assert legs_of(robot).mass == pytest.approx(robot.mass)
    env = SteeringEnv(SteeringConfig.for_robot("walker"))
    for condition in (strict_reachability, collision):
        heights = np.full((1, len(env.points_in_root)), -robot.walking_height, np.float32)
        margin = condition(robot, env.points_in_root)(heights, None)
        assert margin[0] > 0.0
    problem = problem_from_guide(straight(1.0, robot.walking_height), flat(), "walker")
    assert problem.model == "two_com"
    for plan in (plan_mip, plan_sl1m, plan_astar):
        assert plan(problem).status == "feasible", plan.__name__


def test_a_foot_that_is_named_by_its_ankle_is_found_by_its_shape(walker, tmp_path):
    urdf = urdfs.walker(tmp_path / "walker.urdf")
    said: list[str] = []
    sketch = sketch_robot(urdf, MakeOptions(feet=("l_foot", "r_foot")), said.append)
    assert "the frame of 'l_foot', 'r_foot' is 0.067 m from the sole" in said[0]
    by_sole = read_robot(walker / "robots/walker.json")
    for leg, limb in zip(sketch.stance.legs, by_sole.limbs, strict=True):
        np.testing.assert_allclose(
            leg.sole, by_sole.references[by_sole.limbs.index(limb)], atol=1e-4
        )
        np.testing.assert_allclose(leg.reference, limb.model.reference)
        np.testing.assert_allclose(leg.chain.tip.position, limb.model.chain.tip.position)


@pytest.mark.parametrize(("name", "feet"), [("walker", "sole"), ("stilts", "foot")])
def test_pinocchio_finds_the_same(name, feet, request):
    pytest.importorskip("pinocchio")
    made = request.getfixturevalue(name)
    urdf = made[0] if name == "stilts" else made / "walker.urdf"
    options = MakeOptions(feet=(f"l_{feet}", f"r_{feet}"))
    said = compare_with_pinocchio(sketch_robot(urdf, options, print))
    assert "agrees: soles in 50 postures of each leg, mass and centre of mass" in said
