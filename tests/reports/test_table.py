from jaxleas.evaluation.result_file import CellResult, Evaluation
from jaxleas.evaluation.titles import method_title, refined_name, refined_names
from jaxleas.reports.side_by_side import headings, rows
from jaxleas.reports.table import percent, plain_table


def cell(**changes) -> CellResult:
    values = {
        "name": "stairs_up",
        "yaw": 180.0,
        "method": "leas_p1",
        "starts": 1000,
        "reached": 0.985,
        "invalid": 0.01,
        "stopped": 0.005,
        "low": 0.975,
        "high": 0.991,
    }
    return CellResult.model_validate(values | changes)


def evaluation(suite: str, *cells: CellResult) -> Evaluation:
    return Evaluation(
        suite=suite, policy="p", robot="talos", seed=0, created="2026-01-01", cells=cells
    )


def test_only_everything_is_a_hundred_percent():
    assert percent(1.0) == "100.0 %"
    assert percent(0.99996) == "99.9 %"
    assert percent(0.996, 0) == "99 %"
    assert percent(0.125) == "12.5 %"
    assert percent(None) == "-"


def test_the_thesis_stands_beside_our_rows_only():
    text = plain_table(evaluation("transitions", cell(), cell(method="rb_lin")))
    ours, baseline = text.splitlines()[-2:]
    assert ours.split()[:4] == ["stairs", "up", "180°", "LEAS-P1"]
    assert ours.endswith("97 %")
    assert "98.5 %" in ours
    assert baseline.endswith("-")


def test_near_and_far_are_of_the_fraction_that_counts():
    area = {"near": {"starts": 500, "reached": 0.25, "invalid": 0.125}}
    both = area | {"far": area["near"]}
    crossing = plain_table(evaluation("transitions", cell(areas=both)))
    assert crossing.count("25.0 %") == 2
    stopping = plain_table(evaluation("dead_end", cell(areas=both, expectation="stop", high=0.99)))
    assert stopping.count("87.5 %") == 2


def test_columns_without_a_word_are_left_out():
    text = plain_table(
        evaluation("dead_end", cell(name="void", expectation="stop", low=0.98, high=1))
    )
    assert "thesis" not in text
    assert "near" not in text
    assert "stay valid" in text
    assert len({len(line) for line in text.splitlines()[1:3]}) == 1


def test_planners_stand_side_by_side_with_their_titles_and_what_they_report():
    """A planner of the user's own is shown by its name, and never imported for its title."""
    numbers = {"planned": 0.98, "name": "stairs", "speed": 0.2}
    cells = [
        cell(planner="sl1m", **numbers),
        cell(planner="m:Own", **numbers),
        cell(planner="sampling", **numbers),
    ]
    shown = headings(evaluation("thesis", *cells))
    assert shown[6:] == (
        *("SL1M", "95 %", "step"),
        *("m:Own", "95 %", "step"),
        *("sampling", "95 %", "robustness", "step"),
        "thesis",
    )
    robust = cell(planner="m:Own", robustness=3.0, **numbers)
    assert headings(evaluation("thesis", robust))[6:10] == ("m:Own", "95 %", "robustness", "step")
    (row,) = rows(evaluation("thesis", *cells))
    assert len(row) == len(shown)


def test_policies_refined_against_a_planner_bear_its_title():
    assert method_title("leas_p2_mip") == "LEAS-P2 (MIP)"
    assert method_title("leas_p2_m:Own") == "leas_p2_m:Own"
    assert refined_name("mip") in refined_names()
