import numpy as np
import pytest

from jaxleas.evaluation.suites import (
    MAX_SEED,
    MAX_STARTS,
    MAX_TUNING_SEED,
    REPORTED,
    STARTS_PER_SCENE,
    SUITES,
    make_suite,
    scene_seeds,
)
from jaxleas.reports import published
from jaxleas.terrain import PUBLISHED, Scale
from jaxleas.terrain.seeds import EVALUATION_SEED, HELD_OUT_SEED, MAX_TRAINING_SEED, TUNING_SEED
from jaxleas.types import InputError


def vertices(suite):
    return [
        polygon
        for cell in suite.cells
        for scenario in cell.scenarios
        for polygon in scenario.scene.polygons
    ]


@pytest.mark.parametrize("name", SUITES)
def test_the_same_name_starts_and_seed_give_the_same_scenes(name):
    one, other = make_suite(name, 40), make_suite(name, 40)
    assert all(map(np.array_equal, vertices(one), vertices(other)))
    assert [(cell.name, cell.yaw) for cell in one.cells] == [
        (cell.name, cell.yaw) for cell in other.cells
    ]
    shifted = vertices(make_suite(name, 40, seed=1))
    same = [np.array_equal(a, b) for a, b in zip(vertices(one), shifted, strict=False)]
    assert not all(same) or len(shifted) != len(vertices(one))


def test_a_suite_for_a_small_robot_is_the_same_one_made_small():
    suite = make_suite("transitions", 40)
    assert [id(each) for each in vertices(suite.scaled(PUBLISHED))] == [*map(id, vertices(suite))]
    half = suite.scaled(Scale(0.5, 0.7, 0.6))
    assert (suite.scale, half.scale) == (1.0, 0.5)
    for whole, small in zip(vertices(suite), vertices(half), strict=True):
        np.testing.assert_array_equal(small, 0.5 * whole)
    ahead, backwards = (cell for cell in half.cells if cell.name == "bridge")
    assert ahead.scenarios[0] is backwards.scenarios[0]  # rasterised once
    assert (half.seed, half.steps, half.stream()) == (suite.seed, suite.steps, suite.stream())


def test_footsteps_are_those_cells_of_the_thesis_that_chapter_5_asks_about():
    suite, thesis = make_suite("footsteps", 10), make_suite("thesis", 10)
    same = {cell.key: cell for cell in thesis.cells}
    assert {cell.name for cell in suite.cells} == {
        "rubble",
        "stairs_up",
        "stairs_down",
        "long_course",
    }
    for cell in suite.cells:
        assert cell.yaw == 0.0
        assert suite.steps_of(cell) == thesis.steps_of(same[cell.key])


def test_tables_are_those_cells_of_the_thesis_that_its_printed_tables_have():
    suite, thesis = make_suite("tables", 10), make_suite("thesis", 10)
    keys = {(cell.name, cell.yaw, cell.speed) for cell in suite.cells}
    printed = {
        (row.cell, row.yaw, row.speed)
        for table in published.thesis().tables
        if table.table.startswith("4.")
        for row in table.rows
    }
    assert keys == printed | {("wall", 0.0, 0.04)}
    assert {cell.key for cell in suite.cells} <= {cell.key for cell in thesis.cells}
    assert not {"long_course", "circuit"} & {cell.name for cell in suite.cells}  # they take an hour


def test_no_seed_is_ever_trained_or_held_out_on():
    for seed in (0, 1, MAX_SEED - 1):
        seeds = scene_seeds(MAX_STARTS, seed)
        assert min(seeds) >= EVALUATION_SEED > HELD_OUT_SEED > MAX_TRAINING_SEED
    assert not set(scene_seeds(MAX_STARTS, 0)) & set(scene_seeds(MAX_STARTS, 1))


def test_what_is_tuned_on_is_neither_evaluated_nor_trained_on():
    for seed in (0, MAX_TUNING_SEED - 1):
        seeds = scene_seeds(MAX_STARTS, seed, held_out=True)
        assert max(seeds) < EVALUATION_SEED
        assert min(seeds) >= TUNING_SEED > HELD_OUT_SEED > MAX_TRAINING_SEED
    ours, theirs = make_suite("thesis", 20, held_out=True), make_suite("thesis", 20)
    assert ours.name == "thesis_held_out"
    assert [cell.key for cell in ours.cells] == [cell.key for cell in theirs.cells]
    assert ours.stream() not in range(MAX_SEED)  # flat ground is the same, its starts are not
    for mine, other in zip(ours.cells, theirs.cells, strict=True):
        if mine.name != "rotation":
            scenes = [{v.tobytes() for v in each.scene.polygons} for each in mine.scenarios]
            assert all(
                {v.tobytes() for v in each.scene.polygons} not in scenes for each in other.scenarios
            )
    with pytest.raises(InputError, match=f"held-out seeds go from 0 to {MAX_TUNING_SEED - 1}"):
        make_suite("thesis", 20, MAX_TUNING_SEED, held_out=True)


def test_the_thesis_suite_has_its_tables():
    suite = make_suite("thesis", 20)
    keys = [cell.key for cell in suite.cells]
    assert len(set(keys)) == len(keys)
    rotation = [key[1:] for key in keys if key[0] == "rotation"]  # T table 4.1
    assert {(low - spread, low + spread) for low, spread, _ in rotation} == {
        (0.0, 30.0),
        (60.0, 120.0),
        (150.0, 180.0),
    }
    assert len(rotation) == 9
    for name in ("hole_rim", "bridge_ahead", "wall", "rubble", "stairs_up"):  # tables 4.2, 4.3
        assert (name, 0.0, 0.0, 0.04) in keys
    long = next(cell for cell in suite.cells if cell.name == "long_course")
    assert suite.steps_of(long) > suite.steps == suite.steps_of(suite.cells[0])
    assert "thesis" not in REPORTED


def test_transitions_are_the_thesis_table():
    suite = make_suite("transitions", 1000)
    kinds = {"rubble", "bridge", "stairs_down", "stairs_up"}
    assert {(cell.name, cell.yaw) for cell in suite.cells} == {
        (kind, yaw) for kind in kinds for yaw in (0.0, 180.0)
    }
    for cell in suite.cells:
        assert cell.starts == 1000
        assert len(cell.scenarios) == 1000 // STARTS_PER_SCENE
        # The scenes are really different ones.
        assert len({each.scene.polygons[1].tobytes() for each in cell.scenarios}) > 40


def test_dead_ends_must_be_stopped_at_and_all_else_be_crossed():
    for name in SUITES:
        for cell in make_suite(name, 2).cells:
            assert cell.expectation == ("stop" if name == "dead_end" else "cross")
            assert all(each.crossing == (name != "dead_end") for each in cell.scenarios)


def test_a_misspelt_suite_is_answered_with_the_nearest():
    with pytest.raises(InputError, match="did you mean 'dead_end'"):
        make_suite("deadends")
    with pytest.raises(InputError, match="'q'; there are transitions, hole"):
        make_suite("q")


@pytest.mark.parametrize(
    ("starts", "seed", "named"),
    [(0, 0, "starts = 0"), (-5, 0, "starts = -5"), (1, -1, "seed = -1")],
)
def test_numbers_out_of_range_are_refused(starts, seed, named):
    with pytest.raises(InputError, match=named):
        make_suite("hole", starts, seed)


def test_more_starts_than_seeds_are_refused():
    with pytest.raises(InputError, match="at most"):
        make_suite("hole", MAX_STARTS + 1)
    with pytest.raises(InputError, match="from 0 to"):
        make_suite("hole", 1, seed=MAX_SEED)
