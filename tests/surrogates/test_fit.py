"""Fits to planners whose rule is known: what can be learned is learned, and said honestly."""

import numpy as np
import pytest

from jaxleas.surrogates import FitSettings, fit, foreseen_failure, label_paths
from jaxleas.surrogates.splitting import split_by_terrain
from jaxleas.types import InputError

from .walkers import KEEP_EVERY, dizzy, env, flat_atlas, identity, wander

MAPS, KEPT = 8, 9


def walks_of(planner, count, seed=0):
    generator = np.random.default_rng(seed)
    paths = [wander(generator, KEPT) for _ in range(count)]
    last = [planner(path, generator) for path in paths]
    return label_paths(paths, last, np.arange(count) % MAPS, KEEP_EVERY, KEPT)


def coin(path, generator):
    """A planner that fails one stretch in ten, whatever is asked."""
    stretch = int(generator.geometric(0.1))
    return min(KEEP_EVERY * (stretch - 1), len(path) - 1) if stretch < KEPT else len(path) - 1


@pytest.fixture(scope="module")
def memory():
    walks = walks_of(lambda path, _: dizzy(path), 1600)
    # From weights of seed 0 the same is learned, twice as slowly: a plateau comes first.
    settings = FitSettings(epochs=25, code=16, hidden=12, learning_rate=0.01, mirror=False, seed=1)
    return fit(walks, flat_atlas(MAPS), env(), identity(), settings), walks


@pytest.mark.slow
def test_a_rule_that_needs_memory_is_learned(memory):
    report = memory[0].report
    assert report["stretch"]["balanced_accuracy"] > 0.97
    assert report["guide"]["area_under_curve"] > 0.97
    assert report["stretch"]["calibration_error"] < 0.02


def test_foreseen_failures_are_those_of_fresh_walks(memory):
    fresh = walks_of(lambda path, _: dizzy(path), 300, seed=9)
    foreseen = foreseen_failure(memory[0], env(), flat_atlas(MAPS), fresh)
    failed = fresh.failed_at >= 0
    assert 20 < failed.sum() < 280
    assert np.mean(foreseen[failed]) > 0.8
    assert np.mean(foreseen[~failed]) < 0.2


def test_a_planner_like_a_coin_is_known_for_one():
    walks = walks_of(coin, 1600)
    settings = FitSettings(epochs=6, code=16, hidden=8)
    report = fit(walks, flat_atlas(MAPS), env(), identity(), settings).report["stretch"]
    assert report["calibration_error"] < 0.03
    assert report["log_loss"] == pytest.approx(report["log_loss_of_the_share"], rel=0.05)
    assert report["balanced_accuracy"] < 0.6


def test_terrain_that_is_judged_on_is_never_learned_from():
    walks = walks_of(coin, 800)
    split = split_by_terrain(walks, 0.4, seed=3)
    maps = [set(part.map_index) for part in (split.learned, split.calibration, split.judged)]
    assert sum(map(len, maps)) == MAPS == len(set.union(*maps))
    assert len(split.learned) + len(split.calibration) + len(split.judged) == 800


def test_too_few_terrains_or_failures_are_refused():
    with pytest.raises(InputError, match="the planner failed 0 and passed"):
        split_by_terrain(walks_of(lambda path, _: len(path) - 1, 200), 0.3, 0)
    walks = walks_of(coin, 50)[np.arange(50) % MAPS < 3]
    with pytest.raises(InputError, match="come from 3 terrains"):
        split_by_terrain(walks, 0.3, 0)


def test_what_comes_after_a_failure_is_unknown():
    generator = np.random.default_rng(0)
    paths = [wander(generator, KEPT) for _ in range(4)]
    last = [-1, 0, KEEP_EVERY + 2, len(paths[3]) - 1]
    walks = label_paths(paths, last, [0, 0, 0, 0], KEEP_EVERY, KEPT)
    np.testing.assert_array_equal(walks.failed_at, [0, 1, 2, -1])
    np.testing.assert_array_equal(walks.known, [1, 2, 3, KEPT])
    np.testing.assert_array_equal(walks.is_known.sum(axis=1), walks.known)
    np.testing.assert_array_equal(walks.failed.sum(axis=1), [1, 1, 1, 0])
