"""Conditions state their own points, and are combined over the union of these."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxleas.conditions import (
    VOID_IN_ROOT,
    Collision,
    OnPoints,
    Reachability,
    StrictReachability,
    all_of,
    collision,
    extended,
    footprint_points,
    is_under_root,
    reachability,
    read_from,
    strict_reachability,
    union_of_points,
)
from jaxleas.conditions.collision import trunk_bottoms
from jaxleas.envs.steering.layout import ICRA81, THESIS144
from jaxleas.robots import load_talos
from jaxleas.types import InputError, RootMotion

TALOS = load_talos()
SAMPLED = np.concatenate([THESIS144.points_in_root, footprint_points(TALOS)])
PAIRS = {
    Reachability: reachability,
    StrictReachability: strict_reachability,
    Collision: collision,
}


def at_rest(count: int) -> RootMotion:
    return RootMotion(jnp.zeros((count, 3)), jnp.zeros((count, 3)), jnp.zeros(count))


def heights_at(points, count=64, seed=0):
    """Rough ground with holes, known at every point of `SAMPLED` and elsewhere by its place."""
    rng = np.random.default_rng(seed)
    level, slope = rng.uniform(-1.2, -0.6, (count, 1)), rng.normal(size=(count, 2, 1))
    rough = 0.2 * np.sin(40.0 * points[:, 0] + 17.0 * points[:, 1] + 9.0 * level)
    heights = level + 0.3 * (slope * points.T[None]).sum(axis=1) + rough
    return jnp.asarray(np.where(rough < -0.18, VOID_IN_ROOT, heights), jnp.float32)


@pytest.mark.parametrize("kind", PAIRS, ids=lambda kind: kind.__name__)
def test_a_condition_keeps_the_points_that_matter_to_it(kind):
    narrow, wide = kind(TALOS, SAMPLED), PAIRS[kind](TALOS, SAMPLED)
    assert 0 < len(narrow.points_in_root) < len(SAMPLED)
    np.testing.assert_array_equal(wide.points_in_root, SAMPLED)
    margin = narrow(heights_at(narrow.points_in_root), at_rest(64))
    np.testing.assert_array_equal(margin, wide(heights_at(SAMPLED), at_rest(64)))
    assert len(np.unique(margin)) > 10
    # And all of them matter: ground or a post there, over the void, changes the margin.
    count = len(narrow.points_in_root)
    void = jnp.full((count, count), VOID_IN_ROOT)
    nowhere = np.asarray(narrow(void, at_rest(count)))
    filled = [jnp.fill_diagonal(void, z, inplace=False) for z in (-0.9, -0.7, 0.0)]
    changed = [np.asarray(narrow(heights, at_rest(count))) != nowhere for heights in filled]
    assert np.any(changed, axis=0).all()


@pytest.mark.parametrize("layout", [THESIS144, ICRA81], ids=lambda layout: layout.name)
def test_reachability_and_collision_read_what_lies_under_root_or_trunk_in_its_order(layout):
    sampled = np.concatenate([layout.points_in_root, footprint_points(TALOS)])
    both = all_of(StrictReachability(TALOS, sampled), Collision(TALOS, sampled), order=sampled)
    matters = is_under_root(sampled) | np.isfinite(trunk_bottoms(TALOS, sampled))
    np.testing.assert_array_equal(both.points_in_root, sampled[matters])
    narrow = sampled[matters]
    before = all_of(strict_reachability(TALOS, narrow), collision(TALOS, narrow))
    heights = heights_at(narrow)
    np.testing.assert_array_equal(both(heights, at_rest(64)), before(heights, at_rest(64)))


def test_each_condition_of_a_union_reads_its_own_points():
    ahead = np.array([[0.4, 0.0], [0.6, 0.1], [0.9, -0.3]])

    def level_ahead(heights, motion):
        assert heights.shape[-1] == 3
        return 0.3 - (jnp.max(heights, axis=-1) - jnp.min(heights, axis=-1))

    own = OnPoints(ahead, level_ahead)
    parts = [own, Collision(TALOS, SAMPLED), StrictReachability(TALOS, SAMPLED)]
    for order in (None, SAMPLED, SAMPLED[::-1]):
        for conditions in (parts, parts[::-1]):
            union = all_of(*conditions, order=order)
            points = union.points_in_root
            assert len(np.unique(points, axis=0)) == len(points)
            margins = [each(heights_at(each.points_in_root), at_rest(64)) for each in parts]
            least = np.min(margins, axis=0)
            np.testing.assert_array_equal(union(heights_at(points), at_rest(64)), least)
            wider = read_from(np.concatenate([ahead[:1] + 2.0, SAMPLED, ahead]), union)
            heights = heights_at(wider.points_in_root)
            np.testing.assert_array_equal(jax.jit(wider)(heights, at_rest(64)), least)


def test_the_analytic_conditions_are_read_without_a_gather():
    union = all_of(StrictReachability(TALOS, SAMPLED), Collision(TALOS, SAMPLED), order=SAMPLED)
    read = read_from(SAMPLED, union)
    jaxpr = jax.make_jaxpr(read)(jnp.zeros((4, len(SAMPLED))), at_rest(4))
    assert "gather" not in str(jaxpr)


def test_plain_callables_are_given_what_the_others_read():
    def any_ground(heights, motion):
        return jnp.max(heights, axis=-1)

    plain = all_of(any_ground, any_ground)
    assert not hasattr(plain, "points_in_root")
    mixed = all_of(collision(TALOS, SAMPLED), any_ground)
    heights = heights_at(SAMPLED)
    expected = np.minimum(
        collision(TALOS, SAMPLED)(heights, at_rest(64)), any_ground(heights, at_rest(64))
    )
    np.testing.assert_array_equal(mixed(heights, at_rest(64)), expected)
    with pytest.raises(InputError, match="points of its own"):
        all_of(Collision(TALOS, SAMPLED), StrictReachability(TALOS, SAMPLED), any_ground)


def test_points_that_are_not_sampled_are_missed_by_name():
    far = OnPoints(np.array([[3.0, 0.5]]), lambda heights, motion: heights[..., 0])
    with pytest.raises(InputError, match=r"\(3, 0.5\) m, which is not among the 168 points"):
        read_from(SAMPLED, far)


def test_unions_are_unique_ordered_and_idempotent():
    rng = np.random.default_rng(3)
    one, other = rng.normal(size=(5, 2)), rng.normal(size=(4, 2))
    union = union_of_points([one, other, one[::-1]])
    np.testing.assert_array_equal(union, np.concatenate([one, other]))
    np.testing.assert_array_equal(union_of_points([union], order=one[::-1])[:5], one[::-1])
    np.testing.assert_array_equal(extended(one, union), union)
    assert extended(union, one) is union
