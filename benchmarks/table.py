"""One table of all measurements."""

from collections.abc import Sequence

from rich.console import Console
from rich.table import Table

from benchmarks.comparison import Comparison
from benchmarks.measurements import Measurement

STYLES = {"better": "green", "worse": "red", "within": "", "new": "dim"}


def show(rows: Sequence[tuple[Measurement, Comparison]], machine: str) -> None:
    """Print the table."""
    table = Table(title=f"Medians on {machine}", title_justify="left")
    table.add_column("metric", overflow="fold")
    for heading in ("value", "spread", "% of limit", "rival", "x rival", "against baseline"):
        table.add_column(heading, justify="right")
    for each, comparison in rows:
        table.add_row(
            each.name,
            f"{number(each.value)} {each.unit}",
            _spread(each),
            "" if each.of_limit is None else f"{100 * each.of_limit:.3g}",
            "" if each.rival is None else number(each.rival),
            "" if each.ratio is None else f"{each.ratio:.3g}",
            _against(comparison),
            style=STYLES[comparison.verdict],
        )
    # Wide enough for a file, where there is no terminal's width.
    console = Console()
    console = console if console.is_terminal else Console(width=140)
    console.print(table)


def number(value: float | None) -> str:
    """Return a readable value: 1,234,000 or 12.3; "never" for None."""
    if value is None:
        return "never"
    return f"{value:,.0f}" if abs(value) >= 1000 else f"{value:.3g}"


def _spread(each: Measurement) -> str:
    runs = [run for run in each.runs if run is not None]
    if len(runs) < 2 or not each.value:
        return ""
    return f"{100 * (max(runs) - min(runs)) / abs(each.value):.0f} %"


def _against(comparison: Comparison) -> str:
    change = "" if comparison.change is None else f"{100 * comparison.change:+.0f} % "
    return f"{change}{comparison.verdict}"
