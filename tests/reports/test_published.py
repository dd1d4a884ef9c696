"""The thesis's numbers: as printed, and beside ours only where ours were measured."""

import pytest

from jaxleas.evaluation.recipes import RECIPES
from jaxleas.reports.published import published_value, thesis
from jaxleas.reports.thesis_tables import thesis_tables
from tests.reports.test_table import cell, evaluation


@pytest.mark.parametrize(
    ("key", "value"),
    [
        (("planned", "sampling", "rotation", 165.0, 0.0, "leas_p1"), 0.22),
        (("planned", "sampling", "rotation", 90.0, 0.0, "rb_kino"), 0.61),
        (("planned", "sampling", "rotation", 90.0, 0.04, "rb_lin"), None),
        (("robustness", "sampling", "bridge_ahead", 0.0, 0.04, "leas_p2_sampling"), 27.3),
        (("robustness", "sampling", "stairs_up", 0.0, 0.04, "rb_kino_rrt"), 24.3),
        (("planned", "sampling", "stairs_up", 0.0, 0.04, "rb_kino_rrt"), 0.74),
        (("reached", None, "bridge", 180.0, 0.0, "leas_p1"), 0.87),
        (("planned", "mip", "rubble", 0.0, 0.04, "leas_p1"), None),
    ],
)
def test_numbers_are_as_printed(key, value):
    assert published_value(*key) == value


def test_every_printed_cell_is_one_that_the_suites_have():
    rows = {(row.name, row.yaw, row.speed) for row in RECIPES["thesis"].rows}
    rows |= {(row.name, row.yaw, row.speed) for row in RECIPES["transitions"].rows}
    for table in thesis().tables:
        for row in table.rows:
            assert (row.cell, row.yaw, row.speed) in rows
            assert len(row.values) == len(table.methods)


def test_what_was_not_measured_is_said_not_invented():
    assert all(table.is_empty for table in thesis_tables([]))
    measured = cell(
        name="bridge_ahead",
        yaw=0.0,
        speed=0.04,
        method="leas_p1",
        planner="sampling",
        planned=0.9,
        reached=0.95,
        invalid=0.0,
        stopped=0.05,
        robustness=25.04,
        low=0.8,
        high=0.95,
        starts=30,
    )
    ours = evaluation("thesis", measured).model_copy(update={"seed": 4})
    filled = [table for table in thesis_tables([ours]) if not table.is_empty]
    assert len(filled) == 2
    for table in filled:
        entries = dict(table.rows)["bridge ahead, 0°, 0.04 m/s"]
        entry = entries[table.methods.index("LEAS-P1")]
        if "robustness" in table.heading:
            assert (entry.ours, entry.printed) == ("25.0 N", "24.4 N")
            assert entry.under == "27 plans, seed 4"
        else:
            assert (entry.ours, entry.printed) == ("90.0 %", "96.0 %")
            assert entry.under == "80 to 95; 30 starts, seed 4"
        assert entries[0].ours == "-"
        assert entries[0].under == "not measured"
