"""Laws of the margins, then a twin in plain loops."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxleas.conditions import (
    MARGIN_LIMIT,
    VOID_IN_ROOT,
    all_of,
    collision,
    footprint_points,
    is_under_root,
    reachability,
    strict_reachability,
)
from jaxleas.robots import load_talos
from jaxleas.types import InputError, RootMotion

TALOS = load_talos()
POINTS = footprint_points(TALOS)
CONDITIONS = {
    "R": jax.jit(reachability(TALOS, POINTS)),
    "R*": jax.jit(strict_reachability(TALOS, POINTS)),
    "C": jax.jit(collision(TALOS, POINTS)),
}
CONDITIONS["R* and C"] = jax.jit(all_of(CONDITIONS["R*"], CONDITIONS["C"]))


@pytest.fixture(autouse=True)
def _strict_ranks():
    with jax.numpy_rank_promotion("raise"):
        yield


@pytest.fixture(params=CONDITIONS, name="condition")
def each_condition(request):
    return CONDITIONS[request.param]


def at_rest(*batch):
    shapes = (*batch, 3), (*batch, 3), batch
    return RootMotion(*(np.zeros(shape, np.float32) for shape in shapes))


def random_heights(count=256, seed=0, void=0.2):
    """Terrain of every kind, void included, seen from a root about as high as it walks."""
    rng = np.random.default_rng(seed)
    level = rng.uniform(-1.3, -0.5, (count, 1))
    heights = level + rng.normal(size=(count, len(POINTS))) * rng.choice(
        [0.0, 0.03, 0.3], (count, 1)
    )
    heights[rng.random(heights.shape) < void] = VOID_IN_ROOT
    return heights.astype(np.float32)


def test_margins_are_finite_and_bounded_even_over_the_void(condition):
    extremes = (np.full((4, 28), height, np.float32) for height in (-1e30, 1e30))
    for heights in (random_heights(), *extremes):
        margin = condition(heights, at_rest(len(heights)))
        assert margin.dtype == jnp.float32
        assert np.all(np.abs(np.asarray(margin)) <= MARGIN_LIMIT)


def test_both_verdicts_occur(condition):
    satisfied = np.asarray(condition(random_heights(), at_rest(256))) > 0
    assert 0 < satisfied.sum() < 256


def test_one_robot_and_any_batch_agree(condition):
    heights = random_heights()
    margins = np.asarray(condition(heights, at_rest(256)))
    assert condition(heights[7], at_rest()) == margins[7]
    np.testing.assert_array_equal(
        condition(heights.reshape(4, 64, 28), at_rest(4, 64)), margins.reshape(4, 64)
    )


def test_mirrored_ground_gives_the_same_margin(condition):
    mirrored = [
        int(np.argmin(np.linalg.norm(POINTS - point, axis=1)))
        for point in POINTS * np.array([1.0, -1.0])
    ]
    heights = random_heights()
    np.testing.assert_allclose(
        condition(heights[:, np.array(mirrored)], at_rest(256)),
        condition(heights, at_rest(256)),
        atol=1e-6,
    )


def test_margins_are_continuous(condition):
    # One metre of height is worth at most one metre of margin: no margin jumps.
    heights = random_heights(void=0.0)
    nudge = np.random.default_rng(1).uniform(-1e-3, 1e-3, heights.shape).astype(np.float32)
    before, after = (condition(each, at_rest(256)) for each in (heights, heights + nudge))
    change = np.abs(np.asarray(after) - np.asarray(before))
    assert 0 < np.max(change) <= 1.001e-3


def test_it_compiles_once(condition):
    traces = []

    def counted(heights, motion):
        traces.append(heights.shape)
        return condition(heights, motion)

    compiled = jax.jit(counted)
    for seed in range(3):
        compiled(random_heights(seed=seed), at_rest(256))
    assert len(traces) == 1


def test_raising_the_ground_never_frees_the_trunk():
    heights = random_heights()
    raised = heights + np.random.default_rng(2).random(heights.shape, np.float32)
    before, after = (np.asarray(CONDITIONS["C"](each, at_rest(256))) for each in (heights, raised))
    assert np.all(after <= before)
    assert np.any((before > 0) & (after <= 0))


@pytest.mark.parametrize("name", ["R", "R*"])
def test_ground_under_all_legs_fails_reachability(name):
    lowest = min(limb.range_of_motion.bounds.low[2] for limb in TALOS.limbs)
    heights = np.minimum(random_heights(), np.float32(lowest - 0.01))
    assert np.all(np.asarray(CONDITIONS[name](heights, at_rest(256))) < 0)


def test_strict_reachability_implies_reachability():
    heights = random_heights()
    strict, loose = (np.asarray(CONDITIONS[name](heights, at_rest(256))) for name in ("R*", "R"))
    assert np.all(strict <= loose)
    assert np.any((strict <= 0) & (loose > 0))


def test_beside_the_ground_is_reachable_but_not_strictly():
    # T figure 3.8b: above the void, an edge within reach.
    beside = np.where(POINTS[:, 1] > 0.15, -0.95, VOID_IN_ROOT).astype(np.float32)
    assert CONDITIONS["R"](beside, at_rest()) > 0
    assert CONDITIONS["R*"](beside, at_rest()) == -MARGIN_LIMIT


def test_walking_on_level_ground_is_valid_and_a_post_under_the_trunk_is_not():
    level = np.full(28, -TALOS.walking_height, np.float32)
    assert CONDITIONS["R* and C"](level, at_rest()) > 0.1
    for index in range(28):
        post = np.where(np.arange(28) == index, np.float32(-0.6), level)
        assert CONDITIONS["R* and C"](post, at_rest()) < 0


def test_all_of_is_the_least_margin():
    heights = random_heights()
    least = np.minimum(*(CONDITIONS[name](heights, at_rest(256)) for name in ("R*", "C")))
    np.testing.assert_array_equal(CONDITIONS["R* and C"](heights, at_rest(256)), least)
    with pytest.raises(InputError, match="at least one"):
        all_of()


def slow_reach(heights, points):
    best = -np.inf
    for (x, y), height in zip(points, heights, strict=True):
        for limb in TALOS.limbs:
            low, high = -np.inf, np.inf
            for (a, b, c), offset in zip(
                limb.range_of_motion.normals, limb.range_of_motion.offsets, strict=True
            ):
                if c > 0:
                    high = min(high, (offset - a * x - b * y) / c)
                elif c < 0:
                    low = max(low, (offset - a * x - b * y) / c)
                elif a * x + b * y > offset:
                    low = np.inf
            if low <= high:
                best = max(best, min(height - low, high - height))
    return np.clip(best, -1, 1)


def slow_clearance(heights, points):
    worst = np.inf
    for (x, y), height in zip(points, heights, strict=True):
        for box in TALOS.trunk:
            (x0, y0, z0), (x1, y1, _) = box.low, box.high
            if x0 - 1e-6 <= x <= x1 + 1e-6 and y0 - 1e-6 <= y <= y1 + 1e-6:
                worst = min(worst, z0 - height)
    return np.clip(worst, -1, 1)


def test_margins_agree_with_plain_loops():
    rng = np.random.default_rng(5)
    grid = np.concatenate([POINTS, rng.uniform(-0.5, 0.5, (40, 2))])
    heights = rng.uniform(-1.2, -0.5, (60, len(grid)))
    heights[rng.random(heights.shape) < 0.3] = VOID_IN_ROOT
    under = np.all(np.abs(grid) <= 0.1 + 1e-6, axis=1)
    expected = {
        reachability: [slow_reach(row, grid) for row in heights],
        strict_reachability: [slow_reach(row[under], grid[under]) for row in heights],
        collision: [slow_clearance(row, grid) for row in heights],
    }
    for make, slow in expected.items():
        fast = jax.jit(make(TALOS, grid))(jnp.asarray(heights, jnp.float32), at_rest(60))
        np.testing.assert_allclose(fast, slow, atol=1e-6)


def test_the_footprint_covers_the_trunk_and_the_square_under_the_root():
    lowest = TALOS.trunk[0]
    np.testing.assert_allclose(POINTS.min(axis=0), lowest.low[:2])
    np.testing.assert_allclose(POINTS.max(axis=0), lowest.high[:2])
    for axis, most in ((0, 0.112), (1, 0.101)):
        assert np.diff(np.unique(POINTS[:, axis].round(9))).max() <= most
    assert POINTS.shape == (28, 2)
    assert is_under_root(POINTS).sum() == 6
    np.testing.assert_array_equal(
        is_under_root(np.array([[0.1, -0.1], [0.101, 0.0], [0.0, -0.101]])), [True, False, False]
    )


def test_padding_widens_the_trunk():
    beside = np.array([[0.0, 0.0], [0.15, 0.0]])
    heights = jnp.array([-0.95, -0.5])
    assert collision(TALOS, beside)(heights, at_rest()) > 0
    assert collision(TALOS, beside, padding=0.02)(heights, at_rest()) < 0


def test_grids_that_cannot_judge_are_refused():
    far = np.array([[3.0, 0.0]])
    for make in (reachability, strict_reachability, collision):
        with pytest.raises(InputError, match="near the root"):
            make(TALOS, far)
    with pytest.raises(InputError, match="padding"):
        collision(TALOS, POINTS, padding=-0.1)
