"""The decision process of gait planning, with verdicts given: its dynamics, rewards and mirrors."""

from dataclasses import replace

import jax.numpy as jnp
import numpy as np
import pytest

from jaxleas.envs.gait_planning.ground import ground_of, safe_cells
from jaxleas.envs.gait_planning.phases import Phases
from jaxleas.envs.gait_planning.supports import MIRRORED, STANDING
from jaxleas.envs.gait_planning.task import GaitPlanning
from jaxleas.terrain import FIELD_KINDS, FieldConfig, HeightMap, draw_field
from tests.envs.gait_planning.states import (
    WEIGHTS,
    WORLDS,
    drawn_actions,
    drawn_states,
    make_task,
)

COUNT = 64
SWAPPED = [1, 0, 3, 2]


class Lenient(GaitPlanning):
    """The same task, whose transitions are all feasible: what else it does needs no solver."""

    def decide(self, phase, candidate, times, asked):
        return asked.copy(), np.zeros(len(asked), bool)


@pytest.fixture(scope="module")
def task() -> Lenient:
    return Lenient(make_task().config, WORLDS)


@pytest.fixture(scope="module")
def ground(task):
    return task.make_world(range(12), False)


@pytest.fixture(scope="module")
def walked(task, ground):
    """Some steps, so that supports, velocities and feet are no longer those of a start."""
    state, pairs = drawn_states(task, ground, COUNT, seed=1), []
    for step in range(4):
        action = drawn_actions(COUNT, seed=step)
        after, result = task.advance(ground, WEIGHTS, state, action, ())
        pairs.append((state, action, after, result))
        state = after
    return pairs


def test_feet_in_contact_before_and_after_stay(walked):
    moved = 0
    for before, _, after, result in walked:
        stays = STANDING[before.phase.support] & STANDING[after.phase.support]
        np.testing.assert_array_equal(before.phase.feet[stays], after.phase.feet[stays])
        accepted = ~result.terminated
        swung = ~STANDING[before.phase.support] & accepted[:, None]
        moved += (before.phase.feet != after.phase.feet).any(axis=-1)[swung].sum()
    assert moved > COUNT


def test_a_refused_phase_changes_nothing(walked):
    refused = 0
    for before, _, after, result in walked:
        for name in vars(before.phase):
            old, new = (getattr(each.phase, name) for each in (before, after))
            np.testing.assert_array_equal(old[result.terminated], new[result.terminated])
        refused += result.terminated.sum()
        assert (result.reward[result.terminated] == -1.0).all()
    assert refused


def test_feet_are_on_the_ground_and_the_base_above_the_lowest(walked, ground, task):
    for _, _, after, _ in walked:
        phase = after.phase
        for i in range(COUNT):
            feet = phase.feet[i][STANDING[phase.support[i]]]
            heights = ground.heights_at(np.full(len(feet), after.field[i]), feet[:, :2])
            np.testing.assert_array_equal(feet[:, 2], heights)
            assert phase.com[i, 2] - feet[:, 2].min() == pytest.approx(0.45, abs=1e-6)


def test_rewards_are_those_of_table_two(walked):
    """In loops, from the published formulae."""
    nominal = np.array([(0.34, 0.2), (0.34, -0.2), (-0.34, 0.2), (-0.34, -0.2)])
    for before, _, after, result in walked:
        for i in np.flatnonzero(~result.terminated):
            old, new, goal = before.phase, after.phase, before.goal[i].astype(float)
            way = [np.hypot(*(goal - each.feet[i, :, :2].mean(axis=0))) for each in (old, new)]
            c, s = np.cos(float(new.yaw[i])), np.sin(float(new.yaw[i]))
            to_base = np.array([[c, s], [-s, c]])
            ahead = to_base @ (goal - new.com[i, :2])
            facing = 1 - abs(np.arctan2(ahead[1], ahead[0])) / np.pi
            effort = 0.0
            for foot in range(4):
                offset = to_base @ (new.feet[i, foot, :2] - new.com[i, :2]) - nominal[foot]
                effort += abs(offset[0]) ** 3 + abs(offset[1]) ** 3
            ease = max(0.0, 1 - 80 * effort)
            expected = 25 * (way[0] - way[1]) * facing**2 * ease
            expected += 0.3 + 0.2 * (old.support[i] != new.support[i])
            expected -= 0.01 * after.grounded[i].sum()
            assert result.reward[i] == pytest.approx(expected, abs=2e-4)


def test_goals_within_half_a_metre_are_reached(task, ground):
    state = drawn_states(task, ground, COUNT, seed=1)
    near = state.phase.com[:, :2] + np.array([0.4, 0.0], np.float32)
    action = np.zeros((COUNT, 16))
    for goal, reached in ((near, True), (near + np.float32(0.2), False)):
        _, result = task.advance(ground, WEIGHTS, replace(state, goal=goal), action, ())
        assert (result.reached == reached).all()
        assert (result.truncated == reached).all()


def test_grounded_counts_phases_since_a_foot_was_lifted(walked):
    first, action, after, _ = walked[0]
    assert (first.grounded == 1).all()
    expected = np.where(STANDING[action[:, -1].astype(int)], 2, 0)
    np.testing.assert_array_equal(after.grounded, expected)


@pytest.mark.parametrize("kind", FIELD_KINDS)
def test_eight_points_around_a_safe_cell_are_level(kind):
    """T_footholds of D: around every point of a safe cell, 5 cm away, nothing rises by 1 cm."""
    config = make_task().config
    field = draw_field(kind, FieldConfig(length=5.0, width=3.0), 2)
    heights = field.heights.copy()
    heights[[0, -1]] = heights[:, [0, -1]] = np.nan
    framed = HeightMap(heights, field.resolution, field.origin)
    rows, columns = np.nonzero(safe_cells(config, framed))
    assert len(rows)
    generator = np.random.default_rng(0)
    chosen = generator.integers(len(rows), size=2000)
    inside = generator.uniform(0.0, 1.0, (2000, 2))
    points = (np.stack([columns[chosen], rows[chosen]], axis=1) + inside) * field.resolution
    here = framed.height_at(points)
    for angle in np.arange(8) * np.pi / 4:
        there = points + 0.0499 * np.array([np.cos(angle), np.sin(angle)])
        assert (np.abs(framed.height_at(there) - here) <= 0.01).all()


def test_beyond_the_field_nothing_is_safe_and_no_ground(ground):
    away = np.array([[-1.0, 1.0], [100.0, 1.0], [1.0, -0.5], [1.0, 77.0]])
    field = np.zeros(len(away), int)
    assert not ground.safe_at(field, away).any()
    assert (ground.heights_at(field, away) < -100.0).all()


def mirrored_state(state, width: float):
    """Return a state in a world whose left and right are swapped about y = width / 2."""

    def across(points: np.ndarray) -> np.ndarray:
        return np.concatenate([points[..., :1], width - points[..., 1:2], points[..., 2:]], axis=-1)

    phase = state.phase
    image = Phases(
        com=across(phase.com),
        yaw=-phase.yaw,
        velocity=phase.velocity * np.array([1.0, -1.0], np.float32),
        feet=across(phase.feet)[:, SWAPPED],
        support=np.asarray(MIRRORED, np.int32)[phase.support],
    )
    return replace(state, phase=image, goal=across(state.goal), grounded=state.grounded[:, SWAPPED])


@pytest.mark.parametrize("observation", ["light", "published"])
def test_all_is_the_same_in_a_mirror(observation, ground):
    task = Lenient(make_task(observation=observation).config, WORLDS)
    fields = [
        HeightMap(np.where(each > -100, each, np.nan)[::-1].copy(), ground.resolution, (0.0, 0.0))
        for each in ground.heights
    ]
    image_ground = ground_of(task.config, fields, ground.kind)
    width = float(ground.size[1])
    state = drawn_states(task, ground, COUNT, seed=1)
    action = drawn_actions(COUNT, seed=7)
    state, _ = task.advance(ground, WEIGHTS, state, action, ())
    image = mirrored_state(state, width)

    signature = task.signature
    seen = signature.pack(task.look(ground, state))
    seen_image = signature.pack(task.look(image_ground, image))
    expected = np.asarray(signature.mirror(jnp.asarray(seen, jnp.float32)))
    # Points within rounding of a cell's side may fall on either.
    assert (np.abs(seen_image - expected) < 1e-4).mean() > 0.999

    head = signature.heads[0]
    action = drawn_actions(COUNT, seed=8)
    image_action = np.asarray(head.mirrored_raw(jnp.asarray(action)))
    after, result = task.advance(ground, WEIGHTS, state, action, ())
    image_after, image_result = task.advance(image_ground, WEIGHTS, image, image_action, ())
    same = result.terminated == image_result.terminated
    assert same.mean() > 0.98
    np.testing.assert_allclose(image_result.reward[same], result.reward[same], atol=2e-3)
    np.testing.assert_allclose(
        mirrored_state(after, width).phase.feet[same], image_after.phase.feet[same], atol=1e-4
    )


def test_starts_are_at_rest_on_safe_ground_within_reach(task, ground):
    state = drawn_states(task, ground, COUNT, seed=5)
    apart = np.linalg.norm(state.goal - state.phase.com[:, :2], axis=1)
    low, high = task.config.goal_distance
    assert ((apart > low - 1e-3) & (apart < high + 1e-3)).all()
    field = state.field[:, None]
    assert ground.safe_at(field, state.phase.feet[..., :2]).all()
    assert not state.phase.velocity.any()
    examined = task.draw_starts(ground, np.random.default_rng(0), 400, examined=True)
    apart = np.linalg.norm(examined.state.goal - examined.state.phase.com[:, :2], axis=1)
    assert apart.min() > task.config.examined_distance[0] - 1e-3


def test_every_group_begins_somewhere(task, ground):
    starts = task.draw_starts(ground, np.random.default_rng(0), 600)
    assert starts.valid.mean() > 0.5
    assert set(starts.group[starts.valid]) == set(range(len(FIELD_KINDS)))


def test_the_published_code_decides_like_the_head(ground):
    five, published = (
        Lenient(make_task(contact_code=code).config, WORLDS) for code in ("five_way", "published")
    )
    state = drawn_states(five, ground, 5, seed=1)
    numbers = drawn_actions(5, seed=2)[:, :-1]
    code = np.array([[-1, 1, 1], [1, -1, -1], [1, -1, 1], [1, 1, -1], [1, 1, 1]]) * 0.5
    by_index = np.concatenate([numbers, np.arange(5)[:, None]], axis=1)
    first, _ = five.advance(ground, WEIGHTS, state, by_index, ())
    action = np.concatenate([numbers, code], axis=1)
    second, _ = published.advance(ground, WEIGHTS, state, action, ())
    np.testing.assert_array_equal(first.phase.feet, second.phase.feet)
    assert five.signature.action_size == 16
    assert published.signature.action_size == 18


def test_a_proposed_foothold_moves_to_the_nearest_safe_cell_within_the_distance(task):
    config = make_task(snap=0.08).config
    heights = np.zeros((60, 100), np.float32)
    heights[:, 40:50] = np.nan  # a gap across x = 0.8 to 1.0 m
    ground = ground_of(config, [HeightMap(heights, 0.02, (0.01, 0.01))], np.zeros(1, int))
    points = np.array([[0.5, 0.6], [0.78, 0.6], [0.9, 0.6], [1.03, 0.61]])
    moved = ground.snapped(np.zeros(4, int), points, config.snap)
    np.testing.assert_array_equal(moved[0], points[0])  # safe
    np.testing.assert_array_equal(moved[2], points[2])  # too far from any safe cell
    for before, after in zip(points[[1, 3]], moved[[1, 3]], strict=True):
        away = np.linalg.norm(safe_middles(ground) - before, axis=1)
        assert np.linalg.norm(after - before) == pytest.approx(away.min(), abs=1e-6)
    plain = ground_of(task.config, [HeightMap(heights, 0.02, (0.01, 0.01))], np.zeros(1, int))
    np.testing.assert_array_equal(plain.snapped(np.zeros(4, int), points, 0.0), points)


def safe_middles(ground):
    rows, columns = np.nonzero(ground.safe[0])
    return ground.resolution * (np.stack([columns, rows], axis=1) + 0.5)
