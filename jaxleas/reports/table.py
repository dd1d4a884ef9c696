"""Results as a table to read, next to the thesis's."""

from collections.abc import Sequence

from jaxleas.evaluation import AreaResult, CellResult, Evaluation, cell_title, method_title
from jaxleas.guide import LEAS
from jaxleas.reports.published import published_value

THESIS_METHOD = LEAS.key
HEADINGS = (
    "cell",
    "yaw",
    "method",
    "reached",
    "invalid",
    "stopped",
    "95 % interval",
    "near",
    "far",
    "time",
    "length",
    "detour",
    "thesis",
)


def percent(fraction: float | None, digits: int = 1) -> str:
    """Return a fraction in percent; nothing but 1 is ever rounded up to 100."""
    if fraction is None:
        return "-"
    scale = 10**digits
    value = round(100.0 * fraction * scale) / scale
    if fraction < 1.0 and value >= 100.0:
        value = 100.0 - 1.0 / scale
    return f"{value:.{digits}f} %"


def navigation(cell: str, yaw: float) -> float | None:
    """Return T table 3.3: the fraction of 100 starts that reach the goal, by cell and heading."""
    return published_value("reached", None, cell, yaw, 0.0, THESIS_METHOD)


def rows(evaluation: Evaluation) -> list[tuple[str, ...]]:
    """Return the cells of the table as text, one row per cell and method."""
    return [_row(evaluation.suite, cell) for cell in evaluation.cells]


def _row(suite: str, cell: CellResult) -> tuple[str, ...]:
    near, far = cell.areas.get("near"), cell.areas.get("far")
    quoted = suite == "transitions" and cell.method == THESIS_METHOD
    return (
        cell_title(cell.name),
        f"{cell.yaw:.0f}°",
        method_title(cell.method),
        percent(cell.reached),
        percent(cell.invalid),
        percent(cell.stopped),
        f"{percent(cell.low)[:-2]} to {percent(cell.high)}",
        percent(_good(cell, near)),
        percent(_good(cell, far)),
        "-" if cell.mean_time is None else f"{cell.mean_time:.1f} s",
        "-" if cell.mean_length is None else f"{cell.mean_length:.2f} m",
        "-" if cell.detour is None else f"{cell.detour:.2f}",
        percent(navigation(cell.name, cell.yaw), 0) if quoted else "-",
    )


def _good(cell: CellResult, area: AreaResult | None) -> float | None:
    """Return the main fraction in one start area."""
    if area is None:
        return None
    return area.reached if cell.expectation == "cross" else 1.0 - area.invalid


def filled_columns(body: Sequence[Sequence[str]]) -> list[int]:
    """Return the columns with content: the others would only push them off the line."""
    return [column for column in range(len(HEADINGS)) if any(row[column] != "-" for row in body)]


def plain_table(evaluation: Evaluation) -> str:
    """Return the table of an evaluation for a terminal."""
    expected = {cell.expectation for cell in evaluation.cells}
    wanted = "stop and stay valid" if expected == {"stop"} else "reach the goal, always valid"
    starts = evaluation.cells[0].starts if evaluation.cells else 0
    title = f"{evaluation.suite}: {starts} starts a cell, seed {evaluation.seed}; must {wanted}"
    body = rows(evaluation)
    kept = filled_columns(body)
    lines = [[line[column] for column in kept] for line in (HEADINGS, *body)]
    return "\n".join([title, *align(lines, ("cell", "method"))])


def align(lines: Sequence[Sequence[str]], left: Sequence[str]) -> list[str]:
    """Return lines of equal columns, with a rule below the first line, the headings.

    Args:
        lines: headings, then rows.
        left: headings of the columns that are aligned to the left.
    """
    widths = [max(map(len, column)) for column in zip(*lines, strict=True)]
    texts = [
        "  ".join(
            text.ljust(width) if heading in left else text.rjust(width)
            for heading, text, width in zip(lines[0], line, widths, strict=True)
        ).rstrip()
        for line in lines
    ]
    return [texts[0], "-" * max(map(len, texts)), *texts[1:]]
