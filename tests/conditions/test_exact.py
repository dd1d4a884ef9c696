"""The exact twins on scenes made by hand, and against the margins where both must agree."""

import jax.numpy as jnp
import numpy as np
import pytest

from jaxleas.conditions import (
    collision,
    exact_collision,
    exact_reachability,
    exact_strict_reachability,
    footprint_points,
    reachability,
    reconfirm,
    strict_reachability,
)
from jaxleas.robots import load_talos
from jaxleas.types import InputError, RootMotion

TALOS = load_talos()
TWINS = (exact_reachability, exact_strict_reachability, exact_collision)
HEIGHT = TALOS.walking_height


def rectangle(x0, x1, y0, y1, z):
    return np.array([[x0, y0, z], [x1, y0, z], [x1, y1, z], [x0, y1, z]])


def root(x=0.0, y=0.0, z=HEIGHT):
    return np.array([x, y, z])


FLOOR = rectangle(-5, 5, -5, 5, 0.0)


def test_walking_on_a_floor_satisfies_all_three():
    for twin in TWINS:
        assert twin(TALOS, [FLOOR], root(), np.array(0.3)).all()


def test_the_void_fails_reachability_and_frees_the_trunk():
    assert not exact_reachability(TALOS, [], root(), np.array(0.0)).any()
    assert not exact_strict_reachability(TALOS, [], root(), np.array(0.0)).any()
    assert exact_collision(TALOS, [], root(), np.array(0.0)).all()


@pytest.mark.parametrize(("gap", "free"), [(0.0, False), (-0.001, False), (0.001, True)])
def test_a_trunk_touching_is_a_collision_and_a_millimetre_apart_is_not(gap, free):
    bottom = min(box.low[2] for box in TALOS.trunk)
    at = root(z=-bottom + gap)
    assert exact_collision(TALOS, [FLOOR], at, np.array(0.0)) == free
    front = max(box.high[0] for box in TALOS.trunk)
    wall = np.array([[0.0, -1, 0.0], [0.0, 1, 0.0], [0.0, 1, 2.0], [0.0, -1, 2.0]])
    wall[:, 0] = front + gap
    assert exact_collision(TALOS, [wall], root(), np.array(0.0)) == free
    assert exact_collision(TALOS, [wall[:, [1, 0, 2]]], root(), np.array(np.pi / 2)) == free


@pytest.mark.parametrize(("gap", "reached"), [(0.0, True), (-0.001, True), (0.001, False)])
def test_touching_the_range_of_motion_reaches_and_a_millimetre_apart_does_not(gap, reached):
    lowest = TALOS.limbs[0].range_of_motion.bounds.low[2]
    assert exact_reachability(TALOS, [FLOOR], root(z=-lowest + gap), np.array(0.0)) == reached
    ahead = TALOS.limbs[0].range_of_motion.bounds.high[0] + gap
    step = rectangle(ahead, ahead + 1, -1, 1, 0.2)
    assert exact_reachability(TALOS, [step], root(), np.array(0.0)) == reached


@pytest.mark.parametrize(("gap", "reached"), [(0.0, True), (-0.001, True), (0.001, False)])
def test_strict_reach_ends_with_the_square_under_the_root(gap, reached):
    edge = rectangle(0.1 + gap, 2.0, -1, 1, 0.0)
    assert exact_strict_reachability(TALOS, [edge], root(), np.array(0.0)) == reached
    assert exact_reachability(TALOS, [edge], root(), np.array(0.0))


def test_a_small_stone_between_the_points_of_the_map_is_found():
    # What the approximation overlooks and a reconfirmation brings back (T 3.3.1).
    stone = rectangle(-0.04, -0.01, 0.03, 0.06, 0.0)
    points = footprint_points(TALOS)
    assert not np.any(np.all((points > [-0.04, 0.03]) & (points < [-0.01, 0.06]), axis=1))
    position, yaw = np.tile(root(), (2, 1)), np.zeros(2)
    position[1, 0] = 3.0

    def exact(where, heading):
        return exact_strict_reachability(TALOS, [stone], where, heading)

    verdict = reconfirm(np.array([False, False]), position, yaw, exact)
    np.testing.assert_array_equal(verdict, [True, False])


def test_reconfirming_never_withdraws_an_approval_nor_asks_about_it():
    def exact(position, yaw):
        assert len(position) == len(yaw) == 1
        return np.array([True])

    verdict = reconfirm(np.array([True, False]), np.zeros((2, 3)), np.zeros(2), exact)
    assert verdict.all()
    assert reconfirm(np.array([True]), np.zeros((1, 3)), np.zeros(1), exact).all()


def random_scene(rng):
    """Flat, tilted and upright polygons, and roots among them."""
    polygons = []
    for _ in range(30):
        x, y = rng.uniform(-2, 2, 2)
        face = rectangle(-0.3, 0.3, -0.2, 0.2, 0.0) * rng.uniform(0.2, 2.0)
        face[:, 2] = face[:, 0] * rng.choice([0.0, 0.1, 5.0])
        polygons.append(face + np.array([x, y, rng.uniform(-0.2, 0.4)]))
    position = np.column_stack([rng.uniform(-2, 2, (400, 2)), rng.uniform(0.5, 1.4, 400)])
    return polygons, position, rng.uniform(-np.pi, np.pi, 400)


@pytest.mark.parametrize("twin", TWINS)
def test_moving_the_world_and_the_root_together_changes_nothing(twin):
    rng = np.random.default_rng(0)
    polygons, position, yaw = random_scene(rng)
    turn, shift = 1.1, np.array([3.0, -2.0, 0.7])
    cosine, sine = np.cos(turn), np.sin(turn)
    matrix = np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])
    before = twin(TALOS, polygons, position, yaw)
    after = twin(
        TALOS, [p @ matrix.T + shift for p in polygons], position @ matrix.T + shift, yaw + turn
    )
    np.testing.assert_array_equal(before, after)
    assert 0.05 < before.mean() < 0.95


@pytest.mark.parametrize("twin", TWINS)
def test_the_mirrored_world_gets_the_same_verdicts(twin):
    polygons, position, yaw = random_scene(np.random.default_rng(1))
    mirror = np.array([1.0, -1.0, 1.0])
    np.testing.assert_array_equal(
        twin(TALOS, polygons, position, yaw),
        twin(TALOS, [(p * mirror)[::-1] for p in polygons], position * mirror, -yaw),
    )


@pytest.mark.parametrize("twin", TWINS)
def test_one_root_is_a_batch_of_one(twin):
    polygons, position, yaw = random_scene(np.random.default_rng(2))
    batch = twin(TALOS, polygons, position.reshape(20, 20, 3), yaw.reshape(20, 20))
    alone = [twin(TALOS, polygons, position[i], yaw[i]) for i in range(40)]
    np.testing.assert_array_equal(batch.reshape(-1)[:40], alone)


def test_more_ground_never_takes_reach_away_nor_frees_the_trunk():
    polygons, position, yaw = random_scene(np.random.default_rng(3))
    for twin in TWINS[:2]:
        fewer, more = (twin(TALOS, p, position, yaw) for p in (polygons[:15], polygons))
        assert np.all(more >= fewer)
    fewer, more = (exact_collision(TALOS, p, position, yaw) for p in (polygons[:15], polygons))
    assert np.all(more <= fewer)


def test_on_a_level_floor_twins_and_margins_agree():
    # Over an endless floor both know the same: every height of the root, but for a millimetre.
    z = np.arange(0.55, 1.20, 0.0037)
    position = np.column_stack([np.zeros((len(z), 2)), z])
    points = footprint_points(TALOS)
    heights = jnp.asarray(np.tile(-z[:, None], (1, len(points))), jnp.float32)
    motion = RootMotion(jnp.asarray(position), jnp.zeros_like(position), jnp.zeros(len(z)))
    for make, twin, tolerance in (
        (reachability, exact_reachability, 0.005),  # the nearest points miss the tip by this much
        (strict_reachability, exact_strict_reachability, 0.005),
        (collision, exact_collision, 1e-6),
    ):
        margin = np.asarray(make(TALOS, points)(heights, motion))
        exact = twin(TALOS, [FLOOR], position, np.zeros(len(z)))
        clear = np.abs(margin) > tolerance
        np.testing.assert_array_equal((margin > 0)[clear], exact[clear])
        assert 0 < exact.sum() < len(z)


def test_ill_shaped_and_not_finite_roots_are_refused():
    with pytest.raises(InputError, match="one yaw for each"):
        exact_collision(TALOS, [FLOOR], np.zeros((3, 3)), np.zeros(2))
    with pytest.raises(InputError, match="finite"):
        exact_collision(TALOS, [FLOOR], np.full(3, np.nan), np.array(0.0))
