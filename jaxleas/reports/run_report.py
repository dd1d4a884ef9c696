"""The report of a run: one HTML file that needs nothing else."""

import base64
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from jaxleas.evaluation import POLICY, Candidate, CellResult, Evaluation, ReportBasis
from jaxleas.files import read_json, write_bytes, write_text
from jaxleas.guide import BASELINES, is_policy
from jaxleas.reports.gallery import draw_gallery
from jaxleas.reports.learning_curves import draw_learning_curves
from jaxleas.reports.page import page_template
from jaxleas.reports.picture import Picture
from jaxleas.reports.table import (
    HEADINGS,
    cell_title,
    filled_columns,
    method_title,
    navigation,
    percent,
    rows,
)
from jaxleas.runs import read_metrics
from jaxleas.types import InputError

TEMPLATE = "report.html"
MOST_LISTED = 12
"""Greatest number of list entries shown in the provenance; a command line is shorter."""
KINDS = ("rubble", "bridge", "stairs_down", "stairs_up")


@dataclass(frozen=True)
class SuccessRow:
    """One row of the success table: one heading and method over the four transitions."""

    heading: str
    method: str
    values: list[tuple[str, str]]
    """Fraction and interval, as text."""


def write_report(
    run: str | Path,
    candidate: Candidate,
    evaluations: Sequence[Evaluation],
    basis: ReportBasis,
    out: str | Path | None = None,
    progress: Callable[[str], None] = lambda _: None,
) -> Path:
    """Write the report of a run, with its pictures in RUN/pictures.

    The same run folder and evaluations give the same bytes.

    Args:
        run: run folder with config.yaml, provenance.json and metrics.jsonl.
        candidate: policy of the run, which walks for the pictures.
        evaluations: evaluations of the policy, one per suite.
        basis: basis with the scenes to be drawn.
        out: file to write; by default RUN/report.html.
        progress: callable that is given a description of what is being made.

    Returns:
        Path of the written report.

    Raises:
        InputError: a file of the run cannot be read, or the report cannot be written.
    """
    run = Path(run)
    out = run / "report.html" if out is None else Path(out)
    metrics = read_metrics(run / "metrics.jsonl") if (run / "metrics.jsonl").is_file() else []
    progress("report: walking for the pictures")
    pictures = draw_gallery(candidate.env, candidate.methods, basis)
    for picture in pictures:
        write_bytes(run / "pictures" / f"{picture.name}.png", picture.png)
    progress("report: writing")
    write_text(out, render_report(run, metrics, evaluations, pictures))
    return out


def render_report(
    run: Path,
    metrics: Sequence[Mapping[str, Any]],
    evaluations: Sequence[Evaluation],
    pictures: Sequence[Picture],
) -> str:
    """Return the report's HTML: images inline, nothing fetched, no scripts.

    Args:
        run: run folder, for configuration and provenance.
        metrics: rows of metrics.jsonl; empty for a policy without a history.
        evaluations: evaluations of the policy, one per suite.
        pictures: pictures in the order in which they appear.
    """
    by_suite = {evaluation.suite: evaluation for evaluation in evaluations}
    return page_template("jaxleas.reports", TEMPLATE).render(
        name=run.resolve().name,
        headlines=headlines(by_suite, metrics),
        success=success_rows(by_suite.get("transitions")),
        kinds=[cell_title(kind) for kind in KINDS],
        tables=[_table(each) for each in evaluations],
        robot=evaluations[0].robot if evaluations else "",
        pictures=[(each.name, each.caption, inline(each.png)) for each in pictures],
        curves=inline(draw_learning_curves(metrics)) if metrics else None,
        config=_text(run / "config.yaml"),
        provenance=_provenance(run / "provenance.json"),
        seeds=sorted({evaluation.seed for evaluation in evaluations}),
    )


def _table(evaluation: Evaluation) -> dict[str, Any]:
    body = rows(evaluation)
    kept = filled_columns(body)
    return {
        "evaluation": evaluation,
        "columns": [HEADINGS[column] for column in kept],
        "rows": [[row[column] for column in kept] for row in body],
    }


def headlines(
    evaluations: Mapping[str, Evaluation], metrics: Sequence[Mapping[str, Any]]
) -> list[tuple[str, str]]:
    """Return the few numbers that matter: (number, what it says)."""
    numbers = []
    if transitions := evaluations.get("transitions"):
        for yaw, words in ((0.0, "facing the transition"), (180.0, "with the back to it")):
            cells = [cell for cell in _ours(transitions) if cell.yaw == yaw]
            if cells:
                worst = min(cells, key=lambda cell: cell.reached)
                said = f"of {worst.starts} starts {words}, in the worst cell"
                numbers.append((percent(worst.reached), f"{said} ({cell_title(worst.name)})"))
    if hole := evaluations.get("hole"):
        cell = _ours(hole)[0]
        numbers.append((percent(cell.reached), f"of {cell.starts} starts go around a hole"))
    if ends := evaluations.get("dead_end"):
        cells = _ours(ends)
        invalid = sum(cell.invalid * cell.starts for cell in cells)
        starts = sum(cell.starts for cell in cells)
        said = f"of {starts} starts at dead ends meet an invalid configuration"
        numbers.append((percent(invalid / starts), said))
    if metrics:
        seconds, steps = metrics[-1]["seconds"], metrics[-1]["step"] / 1e6
        numbers.append((f"{seconds:.0f} s", f"of training, {steps:.1f} million steps"))
    return numbers


def success_rows(evaluation: Evaluation | None) -> list[SuccessRow]:
    """Return the success table in the shape of T table 3.3, next to the thesis's own numbers."""
    if evaluation is None:
        return []
    table = []
    for yaw in sorted({cell.yaw for cell in evaluation.cells}):
        for method in (POLICY, *BASELINES):
            found = {
                cell.name: cell
                for cell in evaluation.cells
                if cell.yaw == yaw and cell.method == method
            }
            if found:
                values = [_value(found.get(kind)) for kind in KINDS]
                table.append(SuccessRow(f"{yaw:.0f}°", method_title(method), values))
        quoted = [(percent(navigation(kind, yaw), 0), "") for kind in KINDS]
        table.append(SuccessRow(f"{yaw:.0f}°", "thesis, table 3.3", quoted))
    return table


def inline(png: bytes) -> str:
    """Return a PNG as the source of an image, which then needs no file."""
    return "data:image/png;base64," + base64.b64encode(png).decode("ascii")


def _value(cell: CellResult | None) -> tuple[str, str]:
    if cell is None:
        return "-", ""
    return percent(cell.reached), f"{100 * cell.low:.1f} to {100 * cell.high:.1f}"


def _ours(evaluation: Evaluation) -> list[CellResult]:
    """Return the cells of the policy itself."""
    return [cell for cell in evaluation.cells if is_policy(cell.method)]


def _text(path: Path) -> str:
    return path.read_text(encoding="utf-8") if path.is_file() else ""


def _provenance(path: Path) -> list[tuple[str, str]]:
    if not path.is_file():
        return []
    record = read_json(path)
    if not isinstance(record, dict):
        raise InputError(f"{path} is no record of a run: it needs an object")
    return [(key, _plain(value)) for key, value in record.items()]


def _plain(value: Any) -> str:
    """Return a JSON value as a person would write it."""
    if isinstance(value, dict):
        return ", ".join(f"{key} {_plain(each)}" for key, each in value.items())
    if isinstance(value, list):
        more = [f"and {len(value) - MOST_LISTED} more"] if len(value) > MOST_LISTED else []
        return " ".join([_plain(each) for each in value[:MOST_LISTED]] + more) or "none"
    return value if isinstance(value, str) else json.dumps(value)
