import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxleas.envs.steering.config import SteeringConfig
from jaxleas.envs.steering.env import SteeringEnv
from jaxleas.guide import Trips, leas, paths, rb_lin, roll_out
from jaxleas.terrain import HeightMap
from jaxleas.terrain.atlas import make_atlas
from jaxleas.types import InputError, RootMotion
from tests.guide import twin
from tests.guide.walkers import (
    flat_map,
    random_policy,
    small_arena,
    standing,
    starts_on_links,
    waypoints_at,
)

COUNT, STEPS = 48, 60


def stand(heights_in_root, motion, goal):
    return motion


@pytest.fixture(scope="module")
def env():
    return SteeringEnv(SteeringConfig())


@pytest.fixture(scope="module")
def level(env):
    return make_atlas([flat_map()])


@pytest.fixture(scope="module")
def walked():
    """A random policy on a generated arena: policy, map, waypoints, roll-out."""
    policy = random_policy(seed=4)
    env = SteeringEnv(policy.config)
    arena, terrain = small_arena()
    start, waypoints = starts_on_links(env, arena, terrain, COUNT)
    index = jnp.zeros(COUNT, jnp.int32)
    trips = Trips(make_atlas([terrain]), index, start, waypoints)
    rollout = roll_out(env, leas(env, policy), trips, STEPS)
    return policy, env, terrain, waypoints, jax.tree.map(np.asarray, rollout)


def test_every_step_is_the_twins(walked):
    policy, env, terrain, waypoints, rollout = walked
    slow = twin.Twin(policy, env.robot, terrain)
    compared = ambiguous = 0
    for robot in range(COUNT):
        goal = np.asarray(waypoints)[robot, 0]
        for time in range(rollout.end[robot]):
            before, after = (
                (rollout.position[robot, t], rollout.velocity[robot, t], rollout.yaw[robot, t])
                for t in (time, time + 1)
            )
            if slow.is_ambiguous(*before):  # a point on the seam of two cells may fall in either
                ambiguous += 1
                continue
            position, velocity, yaw = slow.step(*before, goal)
            np.testing.assert_allclose(after[0], position, atol=2e-6)
            np.testing.assert_allclose(after[1], velocity, atol=2e-6)
            assert abs(np.angle(np.exp(1j * (after[2] - yaw)))) < 2e-6
            compared += 1
    assert compared > 20 * ambiguous
    assert compared > 400


def test_every_verdict_is_the_twins(walked):
    policy, env, terrain, _, rollout = walked
    slow = twin.Twin(policy, env.robot, terrain)
    verdicts = []
    for robot in range(COUNT):
        for time in range(rollout.end[robot] + 1):
            configuration = rollout.position[robot, time], rollout.yaw[robot, time]
            close = abs(rollout.margin[robot, time]) < 1e-4
            if not close and not slow.is_ambiguous(configuration[0], None, configuration[1]):
                verdicts.append((slow.is_valid(*configuration), bool(rollout.valid[robot, time])))
    assert all(left == right for left, right in verdicts)
    assert {left for left, _ in verdicts} == {True, False}


def test_a_walk_has_one_outcome_and_ends_at_its_first_invalid_configuration(walked):
    *_, rollout = walked
    outcomes = np.stack([rollout.reached, rollout.invalid, rollout.stopped])
    np.testing.assert_array_equal(outcomes.sum(axis=0), 1)
    assert rollout.invalid.any()
    time = np.arange(STEPS + 1)[None, :]
    assert rollout.valid[time < rollout.end[:, None]].all()
    last = rollout.valid[np.arange(COUNT), rollout.end]
    np.testing.assert_array_equal(last, ~rollout.invalid)
    np.testing.assert_array_equal(rollout.valid, rollout.margin >= 0)
    assert (rollout.end[rollout.stopped] == STEPS).all()


def test_configurations_after_the_end_repeat_the_last(walked):
    *_, rollout = walked
    for robot in range(COUNT):
        end = rollout.end[robot]
        for record in (rollout.position, rollout.velocity, rollout.yaw, rollout.margin):
            tail = record[robot, end:]
            np.testing.assert_array_equal(tail, np.broadcast_to(tail[:1], tail.shape))


def test_more_steps_only_lengthen_what_stopped(walked):
    policy, env, terrain, waypoints, rollout = walked
    start = RootMotion(
        jnp.asarray(rollout.position[:, 0]),
        jnp.asarray(rollout.velocity[:, 0]),
        jnp.asarray(rollout.yaw[:, 0]),
    )
    index = jnp.zeros(COUNT, jnp.int32)
    trips = Trips(make_atlas([terrain]), index, start, waypoints)
    short = roll_out(env, leas(env, policy), trips, STEPS // 3)
    end = np.asarray(short.end)
    np.testing.assert_array_equal(end, np.minimum(rollout.end, STEPS // 3))
    np.testing.assert_allclose(
        short.position[:, : STEPS // 3 + 1][:, -1],
        rollout.position[np.arange(COUNT), end],
        atol=1e-6,
    )


def test_one_who_stands_has_stopped(env, level):
    start = standing(env, [(0, 0)])
    rollout = roll_out(env, stand, Trips(level, [0], start, waypoints_at(env, (2, 0))), 10)
    assert bool(rollout.stopped[0])
    assert int(rollout.end[0]) == 10
    (path,) = paths(rollout, 0.2)
    assert len(path) == 11
    np.testing.assert_allclose(path.time, np.arange(11) * 0.2)


def test_one_who_starts_at_the_goal_has_reached_it(env, level):
    start = standing(env, [(1.9, 0)])
    rollout = roll_out(env, stand, Trips(level, [0], start, waypoints_at(env, (2, 0))), 10)
    assert bool(rollout.reached[0])
    assert int(rollout.end[0]) == 0


def test_an_invalid_start_is_a_path_of_one_invalid_configuration(env):
    hole = HeightMap(np.full((9, 9), np.nan, np.float32), 0.1, (-0.4, -0.4))
    start = standing(env, [(0, 0)])
    # At the goal, too: where both hold, invalid counts.
    rollout = roll_out(
        env, stand, Trips(make_atlas([hole]), [0], start, waypoints_at(env, (0, 0))), 10
    )
    assert bool(rollout.invalid[0])
    assert not bool(rollout.reached[0])
    (path,) = paths(rollout, 0.2)
    assert path.valid.tolist() == [False]


def test_waypoints_are_visited_one_after_another(env, level):
    corners = [(1.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0), (0.0, 0.0)]
    start = standing(env, [(0, 0)])
    method = rb_lin(env.config.limits, 0.1)
    rollout = roll_out(env, method, Trips(level, [0], start, waypoints_at(env, *corners)), 800)
    assert bool(rollout.reached[0])
    (path,) = paths(rollout, 0.2)
    visits = [
        int(np.argmax(np.linalg.norm(path.position[:, :2] - corner, axis=1) <= 0.2))
        for corner in corners[:4]
    ]
    assert visits == sorted(visits)
    assert path.length > 3.0  # round the square, though the last corner was at hand from the start
    assert np.linalg.norm(path.position[-1, :2]) <= 0.2 + 1e-6


def test_every_robot_walks_on_its_own_map(env):
    low, high = flat_map(), flat_map()
    high = HeightMap(high.heights + 1.0, high.resolution, high.origin)
    start = standing(env, [(0, 0), (0, 0)])
    goal = jnp.concatenate([waypoints_at(env, (1, 0))] * 2)
    rollout = roll_out(env, stand, Trips(make_atlas([low, high]), [0, 1], start, goal), 5)
    assert np.asarray(rollout.invalid).tolist() == [False, True]


def test_it_stops_computing_when_nobody_walks(env, level):
    calls = []

    def counted(heights_in_root, motion, goal):
        jax.debug.callback(lambda: calls.append(1))
        return rb_lin(env.config.limits, 0.1)(heights_in_root, motion, goal)

    start = standing(env, [(0, 0)])
    rollout = roll_out(env, counted, Trips(level, [0], start, waypoints_at(env, (1.01, 0))), 5000)
    jax.effects_barrier()
    assert int(rollout.end[0]) == 41
    assert len(calls) <= 43


def test_it_compiles_once_for_new_weights_starts_and_goals(level):
    class Counting(SteeringEnv):
        observed = 0

        def observe(self, *arguments):
            self.observed += 1
            return super().observe(*arguments)

    env = Counting(SteeringConfig())
    for seed in range(3):
        start = standing(env, [(0.1 * seed, 0)], yaw=0.1 * seed)
        method = leas(env, random_policy(seed))
        trips = Trips(level, [0], start, waypoints_at(env, (2, seed)))
        roll_out(env, method, trips, 7, 0.1 + seed)
        if seed == 0:
            traced = env.observed
    assert env.observed == traced > 0


@pytest.mark.parametrize(
    ("shape", "steps"),
    [((1, 1, 2), 5), ((1, 0, 3), 5), ((0, 1, 3), 5), ((1, 3), 5), ((1, 1, 3), 0)],
)
def test_nonsense_is_refused(env, level, shape, steps):
    trips = Trips(level, [0], standing(env, [(0, 0)]), jnp.zeros(shape))
    with pytest.raises(InputError, match="roll-out"):
        roll_out(env, stand, trips, steps)


def test_an_environment_of_another_layout_is_refused():
    policy = random_policy(observation="icra81")
    with pytest.raises(InputError, match="observation is thesis144"):
        leas(SteeringEnv(SteeringConfig()), policy)
