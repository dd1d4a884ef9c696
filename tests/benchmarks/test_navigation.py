"""What a comparison of roadmaps counts."""

import pytest

from benchmarks.navigation import Row, cell, summary, within


def row(pair, method, reached, waypoints, connections):
    return Row(pair, method, reached, waypoints, connections, 0.1, 10.0, 100.0)


ROWS = [
    row(0, "leas_p1", True, 0, 1),
    row(1, "leas_p1", True, 4, 90),
    row(2, "leas_p1", False, 0, 500),
    row(0, "rb_kino", True, 6, 120),
    row(1, "rb_kino", False, 2, 500),
    row(2, "rb_kino", False, 2, 500),
]


def test_a_smaller_budget_leaves_what_was_found_within_it():
    assert [each.reached for each in within(ROWS, "leas_p1", 50)] == [True, False, False]
    assert [each.reached for each in within(ROWS, "leas_p1", 90)] == [True, True, False]
    assert [each.reached for each in within(ROWS, "rb_kino", 100)] == [False] * 3


def test_a_cell_counts_successes_and_their_waypoints_only():
    found = cell("arena_500", "leas_p1_rrt", within(ROWS, "leas_p1", 500))
    assert found.reached == pytest.approx(2 / 3, abs=1e-6)
    assert found.reached + found.stopped == pytest.approx(1.0)
    assert found.low < found.reached < found.high
    assert found.waypoints == 2.0
    nothing = cell("arena_50", "rb_kino_rrt", within(ROWS, "rb_kino", 50))
    assert nothing.reached == 0.0
    assert nothing.waypoints is None


def test_the_summary_compares_on_what_all_solve():
    text = summary(ROWS, 3)
    assert "LEAS on the 1 pairs that all solve: 0.00 waypoints" in text
    assert "RB-Kino on the 1 pairs that all solve: 6.00 waypoints" in text
    assert "1 of 3 pairs were solved by none" in text
