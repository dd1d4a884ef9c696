"""Methods side by side: one row per cell and method, the exact planners in columns."""

from collections.abc import Sequence
from collections.abc import Set as AbstractSet

from jaxleas.contacts import measures_of, title_of
from jaxleas.evaluation import CellResult, Evaluation, cell_title, method_title
from jaxleas.reports.published import published
from jaxleas.reports.table import align, percent


def planners_of(evaluation: Evaluation) -> list[str]:
    """Return the names of the planners that judged, in order of appearance."""
    return list(dict.fromkeys(cell.planner for cell in evaluation.cells if cell.planner))


def robust_of(evaluation: Evaluation) -> frozenset[str]:
    """Return the names of the planners that report the robustness of postures."""
    found = {cell.planner for cell in evaluation.cells if cell.robustness is not None}
    return frozenset(
        each
        for each in planners_of(evaluation)
        if each in found or "robustness" in measures_of(each)
    )


def headings(evaluation: Evaluation) -> tuple[str, ...]:
    """Return the titles of the columns."""
    columns = ["cell", "heading", "speed", "method", "valid", "reached"]
    for planner in planners_of(evaluation):
        robustness = ["robustness"] if planner in robust_of(evaluation) else []
        columns += [title_of(planner), "95 %", *robustness, "step"]
    return (*columns, "thesis")


def rows(evaluation: Evaluation) -> list[tuple[str, ...]]:
    """Return the table's rows as text, the cells in the evaluation's order."""
    groups: dict[tuple[str, float, float, float, str], dict[str | None, CellResult]] = {}
    for cell in evaluation.cells:
        key = (cell.name, cell.yaw, cell.yaw_spread, cell.speed, cell.method)
        groups.setdefault(key, {})[cell.planner] = cell
    planners, robust = planners_of(evaluation), robust_of(evaluation)
    return [_row(by_planner, planners, robust) for by_planner in groups.values()]


def _row(
    by_planner: dict[str | None, CellResult], planners: Sequence[str], robust: AbstractSet[str]
) -> tuple[str, ...]:
    one = next(iter(by_planner.values()))
    heading = f"{one.yaw:.0f}°"
    if one.yaw_spread:
        heading = f"{one.yaw - one.yaw_spread:.0f} to {one.yaw + one.yaw_spread:.0f}°"
    texts = [cell_title(one.name), heading, f"{one.speed:.2f}", method_title(one.method)]
    texts += [percent(1.0 - one.invalid), percent(one.reached)]
    for planner in planners:
        texts += _plans(by_planner.get(planner), planner in robust)
    return (*texts, percent(published(one), 0))


def _plans(cell: CellResult | None, is_robust: bool) -> list[str]:
    if cell is None:
        return ["-"] * (4 if is_robust else 3)
    stable = "-" if cell.robustness is None else f"{cell.robustness:.1f}"
    return [
        percent(cell.planned),
        f"{100.0 * cell.low:.0f}-{100.0 * cell.high:.0f}",
        *([stable] if is_robust else []),
        "-" if cell.mean_step is None else f"{100.0 * cell.mean_step:.1f} cm",
    ]


def side_by_side(evaluation: Evaluation) -> str:
    """Return the table for a terminal."""
    starts = evaluation.cells[0].starts if evaluation.cells else 0
    title = (
        f"{evaluation.suite}: {starts} starts a cell, seed {evaluation.seed}; valid: no invalid"
        " configuration; planners: share of all starts that reach the goal and are planned"
    )
    left = ("cell", "method")
    return "\n".join([title, *align([headings(evaluation), *rows(evaluation)], left)])


def markdown(evaluation: Evaluation) -> str:
    """Return the table for a page."""
    lines = [headings(evaluation), tuple("---" for _ in headings(evaluation)), *rows(evaluation)]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)
