"""Tables 4.1, 4.2 and 4.3 of the thesis, each of our numbers next to the printed one."""

from collections.abc import Sequence
from dataclasses import dataclass

from jaxleas.evaluation import CellResult, Evaluation, cell_title, method_title
from jaxleas.reports.published import PublishedRow, PublishedTable, thesis
from jaxleas.reports.table import percent


@dataclass(frozen=True)
class Entry:
    """One number next to the printed one.

    Attributes:
        ours: our number, as text; "-" where it was not measured.
        under: interval of our number, number of starts or guide paths, and seed.
        printed: number of the thesis, as text; "-" where it prints none.
    """

    ours: str
    under: str
    printed: str


@dataclass(frozen=True)
class ThesisTable:
    """One table, rows by cell, columns by method."""

    heading: str
    methods: list[str]
    rows: list[tuple[str, list[Entry]]]

    @property
    def is_empty(self) -> bool:
        """Whether nothing in the table was measured."""
        return all(entry.ours == "-" for _, entries in self.rows for entry in entries)


def thesis_tables(evaluations: Sequence[Evaluation]) -> list[ThesisTable]:
    """Return tables 4.1 to 4.3, filled from evaluations of the suite `thesis`.

    Args:
        evaluations: evaluations to search, in this order; the first that holds a number gives it.
    """
    found = [each for each in evaluations if each.suite in ("thesis", "thesis_held_out")]
    return [_table(table, found) for table in thesis().tables if table.planner is not None]


def _table(table: PublishedTable, evaluations: Sequence[Evaluation]) -> ThesisTable:
    rows = [
        (
            _row_title(row),
            [_entry(table, row, place, evaluations) for place in range(len(table.methods))],
        )
        for row in table.rows
    ]
    heading = f"Table {table.table}. {table.title}"
    return ThesisTable(heading, [method_title(name) for name in table.methods], rows)


def _row_title(row: PublishedRow) -> str:
    ranges = {15.0: "0 to 30°", 90.0: "60 to 120°", 165.0: "150 to 180°"}
    heading = ranges[row.yaw] if row.cell == "rotation" else f"{row.yaw:.0f}°"
    return f"{cell_title(row.cell)}, {heading}, {row.speed:.2f} m/s"


def _entry(
    table: PublishedTable, row: PublishedRow, place: int, evaluations: Sequence[Evaluation]
) -> Entry:
    printed = _text(table.quantity, row.values[place])
    key = (row.cell, row.yaw, row.speed, table.methods[place], table.planner)
    for evaluation in evaluations:
        for cell in evaluation.cells:
            if (cell.name, cell.yaw, cell.speed, cell.method, cell.planner) == key:
                return Entry(
                    _text(table.quantity, getattr(cell, table.quantity)),
                    _under(table.quantity, cell, evaluation.seed),
                    printed,
                )
    return Entry("-", "not measured", printed)


def _text(quantity: str, value: float | None) -> str:
    if value is None:
        return "-"
    return percent(value) if quantity != "robustness" else f"{value:.1f} N"


def _under(quantity: str, cell: CellResult, seed: int) -> str:
    """Return the text below a number: robustness is that of the plans that succeeded."""
    if quantity == "robustness":
        return f"{round((cell.planned or 0.0) * cell.starts)} plans, seed {seed}"
    return f"{100 * cell.low:.0f} to {100 * cell.high:.0f}; {cell.starts} starts, seed {seed}"
