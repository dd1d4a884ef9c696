"""The report of a distilled run: one HTML file, from the files of its folder alone."""

from collections.abc import Collection
from pathlib import Path
from typing import Any

from jaxleas.configuration import load_config
from jaxleas.contacts import title_of
from jaxleas.distillation.config import DistillationConfig
from jaxleas.distillation.folder import DistillationFolder
from jaxleas.distillation.report_data import RunData, read_run_data
from jaxleas.distillation.report_pictures import draw_calibration, draw_learning, draw_rounds
from jaxleas.evaluation import cell_title
from jaxleas.files import write_text
from jaxleas.reports import draw_figures, inline, page_template, percent, thesis, thesis_tables
from jaxleas.reports import headings as side_headings
from jaxleas.reports import rows as side_rows

TEMPLATE = "distilled.html"
_PARTS = ("stretch", "guide")  # the parts of a surrogate's report


def write_distilled_report(run: Path, out: Path | None = None, allow: Collection[str] = ()) -> Path:
    """Write the report of a distilled run; the same files give the same bytes.

    Args:
        run: the distillation's folder.
        out: file to write; by default RUN/report.html.
        allow: planner of the user's own that may be imported, MODULE:CLASS, for its title.

    Raises:
        InputError: no round is finished, or a file of the folder cannot be read.
    """
    config = load_config(DistillationConfig, DistillationFolder(run).config)
    data = read_run_data(run, config.planner)
    target = run / "report.html" if out is None else out
    write_text(target, render(data, config, title_of(config.planner, allow)))
    return target


def render(data: RunData, config: DistillationConfig, planner: str) -> str:
    """Return the report's HTML: images inline, nothing fetched, no scripts.

    Args:
        data: content of the distillation's folder.
        config: configuration of the distillation.
        planner: title of the exact planner.
    """
    figures = draw_figures(data.figures) if data.figures is not None else []
    best = data.best
    return page_template("jaxleas.distillation", TEMPLATE).render(
        name=data.path.resolve().name,
        planner=planner,
        mode=config.mode,
        headlines=headlines(data, config),
        starts=config.judge.starts,
        best=best.round,
        rounds=round_table(data),
        rounds_picture=inline(draw_rounds(data.rounds)),
        surrogates=surrogate_table(data),
        confusions=confusion_tables(best.surrogate),
        calibration=inline(draw_calibration(best.surrogate)) if best.surrogate else None,
        labels=data.labels,
        percent=percent,
        learning=inline(draw_learning(data.start, data.practice)) if data.practice else None,
        learned=thesis().learning_of(config.planner),
        tables=[table for table in thesis_tables(data.evaluations) if not table.is_empty],
        sides=[
            (each, side_headings(each), side_rows(each))
            for each in data.evaluations
            if any(cell.planner for cell in each.cells)
        ],
        figures=[(each.name, each.caption, inline(each.png)) for each in figures],
        missing=data.missing,
        source=thesis().source,
        config=(data.path / "config.yaml").read_text(encoding="utf-8"),
    )


def headlines(data: RunData, config: DistillationConfig) -> list[tuple[str, str]]:
    """Return the few numbers that matter: (number, what it says)."""
    first, best = data.rounds[0], data.best
    cells = len(best.cells)
    guides = cells * config.judge.starts
    words = f"of {guides} starts in {cells} cells, judged exactly on held-out scenes"
    worst = min(best.cells, key=best.cells.__getitem__)
    minutes = sum(sum(row.seconds.values()) for row in data.rounds) / 60
    numbers = [
        (percent(best.success), f"{words}: round {best.round}, the best of all"),
        (percent(first.success), "likewise, the policy begun with"),
        (percent(best.cells[worst]), f"in its worst cell, {cell_title(worst)}"),
        (f"{minutes:.0f} min", f"for {len(data.rounds) - 1} rounds"),
    ]
    if labels := sum(each.guides for each in data.labels):
        numbers.append((f"{labels:,}", "guide paths judged to learn from"))
    return numbers


def round_table(data: RunData) -> dict[str, Any]:
    """Return the table of all rounds, as text."""
    names = list(data.rounds[0].cells)
    return {
        "columns": [
            "round",
            "labels",
            "minutes",
            *map(cell_title, names),
            "mean",
            "robustness [N]",
        ],
        "rows": [
            [
                str(row.round),
                f"{row.labels:,}",
                f"{sum(row.seconds.values()) / 60:.1f}",
                *(percent(row.cells.get(name)) for name in names),
                percent(row.success),
                "-" if row.robustness is None else f"{row.robustness:.1f}",
            ]
            for row in data.rounds
        ],
    }


def surrogate_table(data: RunData) -> list[list[str]]:
    """Return the quality of each round's surrogate, by stretch and guide path, as text."""
    table = []
    for row in data.rounds:
        report = row.surrogate or {}
        for name, part in ((name, report[name]) for name in _PARTS if name in report):
            table.append(
                [
                    str(row.round),
                    name,
                    f"{part['count']:,}",
                    f"{part['failed']:,}",
                    percent(part["balanced_accuracy"]),
                    f"{part['area_under_curve']:.3f}",
                    percent(part["calibration_error"], 2),
                    f"{part['log_loss']:.4f} ({part['log_loss_of_the_share']:.4f})",
                ]
            )
    return table


def confusion_tables(report: dict[str, Any] | None) -> list[tuple[str, dict[str, Any]]]:
    """Return the confusion tables of a surrogate, by stretch and by guide path."""
    return [(name, report[name]["confusion"]) for name in _PARTS] if report else []
