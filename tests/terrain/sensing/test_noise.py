"""Errors of maps from sensors: laws, statistics, and slow twins."""

from functools import partial

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxleas.terrain import HeightMap, NoiseConfig, make_atlas, noise_of, sense
from jaxleas.terrain.sensing.filling import filled_gaps
from jaxleas.terrain.sensing.noise import sensed_map, smooth_field, squares
from jaxleas.types import NO_GROUND, InputError, is_ground
from tests.terrain.sensing.twin import fill_slowly, smooth_slowly, squares_slowly

fill = jax.jit(filled_gaps, static_argnums=2)
CELL = 0.04
SHAPE = (60, 48)


@partial(jax.jit, static_argnums=1)
def sensed(heights, noise, seed):
    return sensed_map(heights, CELL, noise, jax.random.key(seed))


def hilly(void=0.1):
    """Heights of many levels, a share of them without ground."""
    random = np.random.default_rng(0)
    heights = random.uniform(-1.0, 1.0, SHAPE)
    return jnp.asarray(np.where(random.random(SHAPE) < void, NO_GROUND, heights), jnp.float32)


def test_no_noise_changes_nothing_to_the_last_bit():
    assert NoiseConfig().is_none
    assert NoiseConfig(fill=0.2, hole_width=1.0, correlation=0.1).is_none
    found = sensed(hilly(), NoiseConfig(), 0)
    np.testing.assert_array_equal(found.heights, hilly())
    assert not any(np.any(each) for each in found[1:])


def test_equal_keys_give_equal_maps_and_others_others():
    noise = NoiseConfig(white=0.02, correlated=0.01, missing=0.1, holes=0.1, drift=0.02)
    jax.tree.map(
        np.testing.assert_array_equal, sensed(hilly(), noise, 3), sensed(hilly(), noise, 3)
    )
    one, other = sensed(hilly(), noise, 3), sensed(hilly(), noise, 4)
    assert all(np.any(np.asarray(a) != np.asarray(b)) for a, b in zip(one, other, strict=True))


def test_an_error_does_not_move_when_another_is_added():
    """Each error consumes a key of its own."""
    white = sensed(hilly(), NoiseConfig(white=0.02), 0).heights
    both = sensed(hilly(), NoiseConfig(white=0.02, missing=0.05, fill=0.0), 0)
    known = ~np.asarray(both.missing) & np.asarray(is_ground(hilly()))
    np.testing.assert_array_equal(both.heights[known], white[known])


def test_errors_have_the_deviation_that_is_stated_and_leave_void_alone():
    ground = np.asarray(is_ground(hilly()))
    level = jnp.where(is_ground(hilly()), 0.0, NO_GROUND)
    for noise in (NoiseConfig(white=0.03), NoiseConfig(correlated=0.03, correlation=0.08)):
        maps = [np.asarray(sensed(level, noise, seed).heights) for seed in range(20)]
        errors = np.stack([each[ground] for each in maps])
        assert errors.std() == pytest.approx(0.03, rel=0.05)
        assert abs(errors.mean()) < 0.002
        assert all((each[~ground] == NO_GROUND).all() for each in maps)


def test_neighbours_share_a_correlated_error_as_far_as_stated():
    fields = jax.vmap(partial(smooth_field, correlation=5.0))(
        jax.random.normal(jax.random.key(0), (200, *SHAPE))
    )
    fields = np.asarray(fields)
    for away in (1, 5, 10):
        shared = np.mean(fields * np.roll(fields, away, axis=1))
        assert shared == pytest.approx(np.exp(-((away / 5.0) ** 2)), abs=0.03)


def test_smooth_noise_equals_its_slow_twin():
    for shape in ((12, 9), (9, 12)):
        white = np.random.default_rng(1).normal(size=shape)
        found = smooth_field(jnp.asarray(white, jnp.float32), 3.0)
        np.testing.assert_allclose(found, smooth_slowly(white, 3.0), atol=1e-4)


@pytest.mark.parametrize("widest", [0, 1, 2, 4])
def test_filling_equals_its_slow_twin(widest):
    random = np.random.default_rng(widest)
    heights = np.asarray(hilly())
    missing = random.random(SHAPE) < 0.3
    missing[20:26, 20:23] = True
    found, left = fill(jnp.asarray(heights), jnp.asarray(missing), widest)
    wanted, wanted_left = fill_slowly(heights.astype(np.float64), missing, widest)
    np.testing.assert_array_equal(left, wanted_left)
    np.testing.assert_allclose(found, wanted, atol=1e-6)
    np.testing.assert_array_equal(np.asarray(found)[~missing], heights[~missing])


def test_gaps_up_to_the_width_are_filled_on_a_plane_exactly_and_wider_ones_stay():
    row, column = np.mgrid[0:30, 0:30]
    plane = (0.01 * row - 0.02 * column).astype(np.float32)
    for side, stays in ((1, False), (2, False), (3, True), (5, True)):
        missing = np.zeros(plane.shape, bool)
        missing[10 : 10 + side, 12 : 12 + side] = True
        found, left = fill(jnp.asarray(plane), jnp.asarray(missing), 2)  # 8 cm
        np.testing.assert_array_equal(left, missing & stays)
        np.testing.assert_allclose(found, np.where(missing & stays, NO_GROUND, plane), atol=1e-6)


def test_filling_promises_no_ground_beside_void():
    heights = np.zeros((5, 9), np.float32)
    heights[:, 5:] = NO_GROUND
    missing = np.zeros(heights.shape, bool)
    missing[:, 4] = True
    found, left = fill(jnp.asarray(heights), jnp.asarray(missing), 2)
    assert (np.asarray(found)[:, 4] == NO_GROUND).all()
    assert not left.any()


def test_squares_equal_their_slow_twin():
    corner = np.random.default_rng(2).random(SHAPE) < 0.02
    for side in (1, 5):
        found = jax.jit(squares, static_argnums=1)(jnp.asarray(corner), side)
        np.testing.assert_array_equal(found, squares_slowly(corner, side))


def test_shares_of_missing_cells_and_of_holes_are_those_stated():
    level = jnp.zeros((300, 300))
    missing = sensed(level, NoiseConfig(missing=0.02), 0).missing
    assert missing.mean() == pytest.approx(0.02, rel=0.1)
    holes = sensed(level, NoiseConfig(holes=0.1), 0).missing
    assert holes[:-5, :-5].mean() == pytest.approx(0.1, rel=0.15)


def test_heights_are_rounded_to_whole_steps():
    found = np.asarray(sensed(hilly(), NoiseConfig(white=0.02, quantisation=0.05), 0).heights)
    ground = np.asarray(is_ground(hilly()))
    np.testing.assert_allclose(found[ground] / 0.05, np.round(found[ground] / 0.05), atol=1e-4)
    plain = np.asarray(sensed(hilly(), NoiseConfig(white=0.02), 0).heights)
    assert np.abs(found - plain)[ground].max() <= 0.025 + 1e-5
    assert (found[~ground] == NO_GROUND).all()


def test_cells_are_counted_on_ground_alone():
    heights = np.zeros((50, 50), np.float32)
    heights[:, 25:] = np.nan
    atlas = make_atlas([HeightMap(heights, CELL, (0.0, 0.0))])
    seen, count = sense(atlas, NoiseConfig(missing=0.5, fill=0.08), jax.random.key(1))
    assert float(count.missing) == pytest.approx(0.5, abs=0.05)
    assert float(count.filled + count.unknown) == pytest.approx(float(count.missing), abs=1e-6)
    ground = np.asarray(is_ground(atlas.heights))
    lost = ground & ~np.asarray(is_ground(seen.atlas.heights))
    # Some gaps are filled without ground, beside the void: they are filled, not unknown.
    assert lost.sum() >= float(count.unknown) * ground.sum() - 1e-3


def test_tilted_maps_are_off_by_the_slope_and_the_distance_from_the_root():
    atlas = make_atlas([HeightMap(np.zeros((80, 80), np.float32), CELL, (-1.6, -1.6))] * 3)
    seen, _ = sense(atlas, NoiseConfig(drift=0.05), jax.random.key(0))
    points = np.array([[0.0, 0.0], [0.5, 0.0], [0.0, 0.5], [0.3, -0.4]])
    index = jnp.arange(3)
    position = jnp.asarray([[0.1, 0.2, 0.9]] * 3, jnp.float32)
    yaw = jnp.asarray([0.0, 1.0, 2.0])
    found = jax.jit(lambda: seen.heights_around(index, position, yaw, points))()
    np.testing.assert_allclose(found, -0.9 + np.asarray(seen.tilt) @ points.T, atol=1e-5)
    np.testing.assert_allclose(np.linalg.norm(seen.tilt, axis=1), 0.05, rtol=1e-4)
    assert len(np.unique(np.asarray(seen.tilt)[:, 0])) == 3


@pytest.mark.parametrize(
    ("words", "part"),
    [
        (["white=3"], "white is 3"),
        (["missing=-0.1"], "missing is -0.1"),
        (["wite=0.1"], "there is no wite; perhaps you meant white"),
        (["white"], "settings look like white=0.02"),
        (["delay=1.5"], "delay is 1.5"),
        (["white=[1"], "is not YAML"),
        (["white=.nan"], "white"),
    ],
)
def test_noise_out_of_range_is_one_sentence(words, part):
    with pytest.raises(InputError) as refused:
        noise_of(words)
    assert str(refused.value).startswith("--noise")
    assert part in str(refused.value)


def test_words_that_state_no_noise_are_no_noise():
    assert noise_of(None) is None
    assert noise_of(["white=0", "fill=0.1"]) is None
    assert noise_of(["white=0.02", "missing=0.02"]) == NoiseConfig(white=0.02, missing=0.02)
