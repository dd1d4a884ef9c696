"""A suite for one robot, and roll-outs judged on the polygons."""

from dataclasses import replace

import pytest

from jaxleas.evaluation.exactly import judged_exactly
from jaxleas.evaluation.judge import judge
from jaxleas.evaluation.roll_outs import roll_out_cell
from jaxleas.evaluation.starts import draw_starts, make_grounds
from jaxleas.evaluation.suited import suited
from jaxleas.evaluation.suites import Cell, Suite, make_suite
from jaxleas.guide import BASELINES
from jaxleas.robots import load_robot
from jaxleas.terrain import Bar, Limit, limit_scenario

SIZES = {"crossable": 0.1, "between": 0.27, "hopeless": 0.4}


def gaps(*sizes: float) -> Suite:
    scenarios = tuple(limit_scenario("gap", Limit(gap=size), 0.0) for size in sizes)
    return Suite("limits", 0, 400, (Cell("gap", 0.0, scenarios, 6, exactly=True),))


def test_a_cell_is_parted_by_what_the_robot_can_cross():
    parts = suited(gaps(0.27, 0.1, 0.4, 0.41), load_robot("talos")).cells
    assert [(each.name, each.expectation, each.starts) for each in parts] == [
        ("gap_crossable", "cross", 6),
        ("gap_between", "stop", 6),
        ("gap_hopeless", "stop", 6),
    ]
    assert [[each.limit.gap for each in part.scenarios] for part in parts] == [
        [0.1],
        [0.27],
        [0.4, 0.41],
    ]


def test_a_smaller_robot_gets_smaller_limits():
    g1 = load_robot("g1")
    suite = suited(gaps(0.1), g1)
    assert suite.cells[0].scenarios[0].limit.gap == pytest.approx(0.1 * suite.scale)
    assert suite.scale < 0.8


def test_a_suite_without_limits_keeps_its_cells():
    suite = make_suite("hole", 2)
    assert suited(suite, load_robot("talos")).cells == suite.cells


def test_a_wall_that_the_map_overlooks_ends_a_roll_out(env):
    """Between the points at which a policy is judged, 10 cm apart, a thin post is not seen."""
    thin = Limit(bars=(Bar(0.02, 0.02, 0.0, 1.5),), period=4.0)
    cell = Cell("post", 0.0, (limit_scenario("post", thin, 0.0, shift=0.03),), 16, exactly=True)
    grounds = make_grounds([cell])
    starts = draw_starts(env, grounds, cell, 0)
    walked = roll_out_cell(env, grounds, BASELINES["rb_lin"].make(env, None), starts, 500)
    assert walked.reached.any()
    exactly = judged_exactly(env.robot, cell, walked)
    assert exactly.invalid.all()
    assert not exactly.reached.any()
    assert (exactly.end <= walked.end).all()
    at_end = exactly.position[range(16), exactly.end]
    assert (at_end[:, 0] < 0.0).all()  # the trunk touches the post before the root is there


def test_what_the_polygons_allow_stays_as_it_was(env):
    suite = gaps(0.1)
    walks = {"rb_lin": BASELINES["rb_lin"].make(env, None)}
    exactly = judge(env, walks, suite)
    plain = judge(env, walks, replace(suite, cells=(replace(suite.cells[0], exactly=False),)))
    assert exactly == plain
