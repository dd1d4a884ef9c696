import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxleas.envs.steering.config import GuardConfig
from jaxleas.envs.steering.env import SteeringEnv
from jaxleas.export import build_onnx
from jaxleas.export.write import described
from jaxleas.guide import leas
from jaxleas.guide.commands import walk_queries
from jaxleas.guide.onnx_policy import onnx_policy_from_bytes
from jaxleas.terrain.atlas import make_atlas
from jaxleas.types import Query, RootPose
from jaxleas.viewer.driven_robot import DrivenRobot
from tests.guide.walkers import flat_map, random_policy

POLICY = random_policy(seed=4)
FEARLESS = SteeringEnv(POLICY.config, lambda _, motion: jnp.ones_like(motion.yaw))
TERRAIN = flat_map()
START = RootPose.from_yaw(np.array([0.3, -0.2, 0.95]), 0.4)
GOAL = (30.0, 2.0)


def walker(policy=POLICY, env=FEARLESS) -> DrivenRobot:
    made = DrivenRobot("some policy", env, policy, make_atlas([TERRAIN]))
    made.reset(START)
    return made


@pytest.mark.parametrize("kind", ["jax", "onnx"])
def test_it_walks_step_by_step_where_the_roll_out_walks(kind):
    policy = POLICY
    if kind == "onnx":
        content = build_onnx(POLICY, described(POLICY.config))
        policy = onnx_policy_from_bytes(content, "policy.onnx")
    robot = walker(policy)
    robot.seek(GOAL)
    query = Query((0.3, -0.2, 0.95), 0.4, (0.0, 0.0, 0.0), GOAL)
    expected = walk_queries(FEARLESS, leas(FEARLESS, POLICY), TERRAIN, [query], 40)
    for index in range(1, 41):
        robot.step()
        np.testing.assert_allclose(robot.pose.position, expected.position[0, index], atol=1e-5)
        assert robot.pose.yaw == pytest.approx(float(expected.yaw[0, index]), abs=1e-5)


def test_a_guarded_robot_stops_where_it_would_fail():
    for enabled, state in ((False, "invalid"), (True, "walking")):
        policy = random_policy(seed=4, guard=GuardConfig(enabled=enabled))
        robot = walker(policy, SteeringEnv(policy.config))
        robot.seek(GOAL)
        for _ in range(60):
            robot.step()
            if robot.state != "walking":
                break
        assert robot.state == state


def test_nothing_is_compiled_while_driving():
    robot = walker()
    before = robot._move._cache_size(), robot._look._cache_size()
    for goal in (GOAL, (-3, 1), (np.float64(0.5), 2)):
        robot.seek(goal)
        for _ in range(3):
            robot.step()
        robot.stop()
    robot.reset(START)
    robot.seek(GOAL)
    robot.step()
    assert (robot._move._cache_size(), robot._look._cache_size()) == before == (1, 1)


def test_it_arrives_stands_and_walks_on():
    robot = walker()
    assert robot.state == "waiting"
    robot.seek((0.35, -0.2))
    robot.step()
    assert robot.state == "arrived"
    assert not np.asarray(robot._motion.velocity).any()
    robot.seek(GOAL)
    assert robot.state == "walking"
    robot.stop()
    assert robot.state == "waiting"


def test_an_invalid_configuration_ends_the_walk_until_it_is_reset():
    robot = walker(env=SteeringEnv(POLICY.config))
    robot.reset(RootPose.from_yaw(np.array([0.0, 0.0, 1.4]), 0.0))
    assert robot.state == "invalid"
    assert robot.sight.margin < 0.0
    robot.seek(GOAL)
    assert robot.state == "invalid"
    robot.reset(START)
    assert robot.state == "waiting"


def test_it_shows_the_points_it_sees_where_they_are():
    robot = walker()
    robot.reset(RootPose.from_yaw(np.array([1.0, 2.0, 0.95]), np.pi / 2))
    points = robot.points_seen()
    np.testing.assert_allclose(points[:, :2], FEARLESS.layout.points_in_root)
    assert points[:, 2] == pytest.approx(-0.95, abs=1e-6)  # level ground, nothing clipped


def test_it_moves_evenly_between_configurations_and_the_short_way_round():
    robot = walker()
    robot.before = RootPose.from_yaw(np.array([0.0, 0.0, 1.0]), 3.1)
    robot.pose = RootPose.from_yaw(np.array([1.0, 0.0, 2.0]), -3.1)
    half = robot.between(0.5)
    assert half.position == pytest.approx([0.5, 0.0, 1.5])
    assert np.cos(half.yaw) == pytest.approx(-1.0)


def test_a_policy_that_answers_with_no_number_leaves_the_robot_where_it_was():
    robot = walker()
    robot.reset(START)
    robot.seek((2.0, 0.0))
    robot._move = lambda heights, motion, goal: jax.tree.map(lambda leaf: leaf * jnp.nan, motion)
    with jax.debug_nans(False):
        robot.step()
    assert robot.state == "invalid"
    np.testing.assert_allclose(robot.pose.position, START.position)
