"""A comparison as tables of text, as plain values, and as one HTML file."""

import base64
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from jaxleas.evaluation import cell_title
from jaxleas.records.comparison import Comparison, Score, apart
from jaxleas.records.listing import as_json, as_text, cut, duration
from jaxleas.records.record import HELD_OUT, SUITE
from jaxleas.reports import (
    COLOURS,
    DPI,
    align,
    blank_picture,
    dress,
    page_template,
    percent,
    png_of,
    series,
)

TEMPLATE = "comparison.html"
WIDEST = 44
"""Maximum width of a value of a configuration or provenance in a table [characters]."""


@dataclass(frozen=True)
class Section:
    """A table under a title; `remark` explains it."""

    title: str
    headings: tuple[str, ...]
    rows: list[tuple[str, ...]]
    remark: str = ""


def names_of(comparison: Comparison) -> list[str]:
    """Return the shortest names that still distinguish the runs."""
    paths = [run.path.resolve().parts for run in comparison.runs]
    names = [str(run.path) for run in comparison.runs]
    for count in range(max(map(len, paths)), 0, -1):
        shorter = ["/".join(parts[-count:]) for parts in paths]
        if len({*shorter}) < len({*paths}):
            break
        names = shorter
    return names


def sections(comparison: Comparison) -> list[Section]:
    """Return all differences and all measurements as tables."""
    names = tuple(names_of(comparison))
    runs = comparison.runs
    overview = [
        ("state", *[run.state for run in runs]),
        ("steps", *[f"{run.steps / 1e6:.2f} M" for run in runs]),
        ("time", *[duration(run.seconds) for run in runs]),
        ("best held out", *[percent(run.held_out) for run in runs]),
        ("transitions, mean", *[percent(run.success) for run in runs]),
    ]
    found = [Section("Runs", ("", *names), overview)]
    for title, values in (
        ("Configuration", comparison.config),
        ("Provenance", comparison.provenance),
    ):
        rows = [(key, *[_value(each) for each in row]) for key, row in values.items()]
        remark = "" if rows else "no difference"
        found.append(Section(title, ("what differs", *names), rows, remark))
    curves = [
        (f"{step / 1e6:.2f} M", *[_score(each) for each in scores])
        for step, scores in comparison.curves.items()
    ]
    found.append(Section("Held-out success", ("steps", *names), curves, _unless(curves)))
    suites = list(dict.fromkeys(suite for suite, _ in comparison.scores))
    suites.sort(key=lambda suite: suite != SUITE)
    for suite in suites:
        rows = [
            (cell_title(cell), *[_score(each) for each in scores], "*" if apart(scores) else "")
            for (of, cell), scores in comparison.scores.items()
            if of == suite
        ]
        remark = "95 % intervals; * where two have nothing in common"
        found.append(Section(f"Success: {suite}", ("cell", *names, ""), rows, remark))
    if not suites:
        found.append(Section("Success", ("cell", *names), [], "not judged yet: jaxleas evaluate"))
    return found


def plain(comparison: Comparison) -> str:
    """Return the comparison as text for a terminal."""
    blocks = []
    for section in sections(comparison):
        lines = [section.title] + ([f"({section.remark})"] if section.remark else [])
        if section.rows:
            lines += align([section.headings, *section.rows], (section.headings[0],))
        blocks.append("\n".join(lines))
    return "\n\n".join(blocks)


def to_json(comparison: Comparison) -> Mapping[str, Any]:
    """Return the comparison as plain values."""

    def scores(row: Sequence[Score | None]) -> list[dict[str, Any] | None]:
        return [None if each is None else vars(each) for each in row]

    return {
        "runs": [as_json(run) for run in comparison.runs],
        "config": comparison.config,
        "provenance": comparison.provenance,
        "held_out": {str(step): scores(row) for step, row in comparison.curves.items()},
        "success": [
            {"suite": suite, "cell": cell, "scores": scores(row), "apart": apart(row)}
            for (suite, cell), row in comparison.scores.items()
        ],
    }


def draw(comparison: Comparison) -> bytes:
    """Draw the learning curves over each other and return them as a PNG."""
    figure = blank_picture(11.2, 4.2)
    panels = (
        ("Held-out links reached", HELD_OUT, "% of starts", 100.0),
        ("Reward", "walk/reward", "per step", 1.0),
    )
    for ax, (title, metric, unit, factor) in zip(figure.subplots(1, 2).flat, panels, strict=True):
        for number, (run, name) in enumerate(
            zip(comparison.runs, names_of(comparison), strict=True)
        ):
            steps, values = series(run.metrics, metric, factor)
            style = ("-", "--", ":")[number // len(COLOURS) % 3]
            colour = COLOURS[number % len(COLOURS)]
            ax.plot(steps, values, style, color=colour, label=name, linewidth=1.4)
        ax.set_title(title, loc="left", fontsize=10, fontweight="bold")
        ax.set(xlabel="environment steps [million]", ylabel=unit)
        ax.set_xlim(left=0.0)
        dress(ax)
        ax.legend(frameon=False, fontsize=8)
    return png_of(figure, DPI)


def to_html(comparison: Comparison) -> str:
    """Return the comparison as one self-contained HTML file."""
    picture = base64.b64encode(draw(comparison)).decode("ascii")
    return page_template("jaxleas.records", TEMPLATE).render(
        names=names_of(comparison), sections=sections(comparison), picture=picture
    )


def _value(value: Any) -> str:
    return cut(as_text(value), WIDEST)


def _score(score: Score | None) -> str:
    if score is None:
        return "-"
    return f"{percent(score.success)} ({100 * score.low:.1f} to {100 * score.high:.1f})"


def _unless(rows: Sequence[object]) -> str:
    return "95 % intervals" if rows else "no run was examined yet"
