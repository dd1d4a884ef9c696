"""The table of a distillation's rounds, as text."""

from collections.abc import Sequence

from jaxleas.distillation.round_result import RoundResult


def table_of(results: Sequence[RoundResult]) -> str:
    """Return the exact success of each round, cell by cell [%], and its plans' robustness."""
    names = list(results[0].cells)
    heads = ["round", "labels", "minutes", *names, "mean", "robustness [N]"]
    rows = [
        [
            str(each.round),
            str(each.labels),
            f"{sum(each.seconds.values()) / 60:.1f}",
            *(f"{100 * each.cells[name]:.1f}" for name in names),
            f"{100 * each.success:.1f}",
            "-" if each.robustness is None else f"{each.robustness:.1f}",
        ]
        for each in results
    ]
    widths = [max(len(row[column]) for row in [heads, *rows]) for column in range(len(heads))]
    return "\n".join(
        "  ".join(text.rjust(width) for text, width in zip(row, widths, strict=True))
        for row in [heads, *rows]
    )
