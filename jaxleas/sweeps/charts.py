"""The charts of a sweep's report, as SVG with tooltips, without files or scripts."""

import math
from collections.abc import Mapping, Sequence
from html import escape
from typing import Any

from jaxleas.sweeps.config import Dimension
from jaxleas.sweeps.results import TrialResult, shown_param

WIDTH, HEIGHT, MARGIN = 960, 340, 60
_LOW, _HIGH = (200, 206, 214), (31, 95, 208)  # colours of the worst and the best trial
_OTHERS = "#b9b9b4"


def parallel_coordinates(
    results: Sequence[TrialResult],
    space: Mapping[str, Dimension],
    measure: str,
    maximised: bool,
) -> str:
    """Draw one axis per searched field, one for the objective, and one line per trial.

    Args:
        results: results of the trials; those that are not done are left out.
        space: search space of the sweep.
        measure: name of the objective.
        maximised: whether higher values of the objective are better.
    """
    done = sorted(
        (each for each in results if each.state == "done"),
        key=lambda each: each.values[measure],
        reverse=not maximised,
    )
    names = [*space, measure]
    gap = (WIDTH - 2 * MARGIN) / max(1, len(names) - 1)
    values = [each.values[measure] for each in done]
    low, high = (min(values), max(values)) if values else (0.0, 1.0)
    parts = []
    for result in done:
        shares = [place_on(space[name], result.params.get(name)) for name in space]
        shares.append(_share(result.values[measure], low, high))
        points = [
            f"{MARGIN + index * gap:.1f},{_height(share):.1f}"
            for index, share in enumerate(shares)
            if share is not None
        ]
        goodness = shares[-1] if maximised else 1.0 - (shares[-1] or 0.0)
        parts.append(
            f'<polyline points="{" ".join(points)}" stroke="{_colour(goodness or 0.0)}">'
            f"<title>{escape(_words(result, measure))}</title></polyline>"
        )
    for index, name in enumerate(names):
        x = MARGIN + index * gap
        ends = _ends(space[name]) if name in space else (f"{low:.4g}", f"{high:.4g}")
        parts.append(_axis(x, name, ends))
    return _svg("".join(parts), "lines")


def importance_bars(importance: Mapping[str, float]) -> str:
    """Draw how much each searched field matters, as bars."""
    parts = []
    for row, (name, share) in enumerate(importance.items()):
        y = 14 + 26 * row
        length = 560 * share / max(importance.values()) if max(importance.values()) > 0 else 0.0
        parts.append(
            f'<text x="270" y="{y + 12}" text-anchor="end">{escape(name)}</text>'
            f'<rect x="280" y="{y}" width="{length:.1f}" height="16" fill="rgb{_HIGH}"/>'
            f'<text x="{288 + length:.1f}" y="{y + 12}">{100 * share:.0f} %</text>'
        )
    return _svg("".join(parts), "bars", 24 + 26 * len(importance))


def learning_curves(
    curves: Mapping[str, Sequence[tuple[int, float]]], best: Sequence[str], total: int
) -> str:
    """Draw held-out success over steps, one line per training, those of the best trials in colour.

    Args:
        curves: points (steps, success) of each line, by its name.
        best: names of the lines to emphasise.
        total: number of steps of a whole training.
    """
    parts = [_axis_lines(total)]
    for name in sorted(curves, key=lambda each: each in best):
        points = " ".join(
            f"{MARGIN + (WIDTH - 2 * MARGIN) * step / total:.1f},{_height(success):.1f}"
            for step, success in curves[name]
        )
        colour = f"rgb{_HIGH}" if name in best else _OTHERS
        parts.append(
            f'<polyline points="{points}" stroke="{colour}">'
            f"<title>{escape(name)}</title></polyline>"
        )
    return _svg("".join(parts), "lines")


def place_on(dimension: Dimension, value: Any) -> float | None:
    """Return a value's position on its axis, from 0 (bottom) to 1 (top); None: not drawn."""
    if value is None:
        return None
    if dimension.choices is not None:
        last = len(dimension.choices) - 1
        index = next(i for i, each in enumerate(dimension.choices) if each == _plain(value))
        return index / last if last else 0.5
    low, high = dimension.ends
    if dimension.log:
        return math.log(value / low) / math.log(high / low)
    return (value - low) / (high - low)


def _plain(value: Any) -> Any:
    return list(value) if isinstance(value, tuple) else value


def _share(value: float, low: float, high: float) -> float:
    return (value - low) / (high - low) if high > low else 0.5


def _height(share: float) -> float:
    return MARGIN + (1.0 - share) * (HEIGHT - 2 * MARGIN)


def _colour(goodness: float) -> str:
    mixed = [round(a + goodness * (b - a)) for a, b in zip(_LOW, _HIGH, strict=True)]
    return f"rgb({mixed[0]},{mixed[1]},{mixed[2]})"


def _ends(dimension: Dimension) -> tuple[str, str]:
    if dimension.choices is not None:
        return str(dimension.choices[0]), str(dimension.choices[-1])
    low, high = dimension.ends
    return f"{low:.4g}", f"{high:.4g}{' (log)' if dimension.log else ''}"


def _axis(x: float, name: str, ends: tuple[str, str]) -> str:
    top, foot = _height(1.0), _height(0.0)
    last = name.rpartition(".")[2]
    return (
        f'<line x1="{x:.1f}" x2="{x:.1f}" y1="{top}" y2="{foot}"/>'
        f'<text x="{x:.1f}" y="{foot + 18}" text-anchor="middle">{escape(ends[0])}</text>'
        f'<text x="{x:.1f}" y="{top - 8}" text-anchor="middle">{escape(ends[1])}</text>'
        f'<text x="{x:.1f}" y="{foot + 38}" text-anchor="middle" font-weight="600">'
        f"{escape(last)}<title>{escape(name)}</title></text>"
    )


def _axis_lines(total: int) -> str:
    left, right = MARGIN, WIDTH - MARGIN
    parts = [
        f'<line x1="{left}" x2="{right}" y1="{_height(share)}" y2="{_height(share)}"/>'
        f'<text x="{left - 8}" y="{_height(share) + 4}" text-anchor="end">{100 * share:.0f} %'
        "</text>"
        for share in (0.0, 0.25, 0.5, 0.75, 1.0)
    ]
    parts.append(
        f'<text x="{right}" y="{_height(0.0) + 22}" text-anchor="end">{total:,} steps</text>'
    )
    return "".join(parts)


def _words(result: TrialResult, measure: str) -> str:
    params = ", ".join(f"{name} {shown_param(value)}" for name, value in result.params.items())
    return f"trial {result.number}: {measure} {result.values[measure]:.4g}; {params}"


def _svg(content: str, kind: str, height: int = HEIGHT) -> str:
    return f'<svg class="{kind}" viewBox="0 0 {WIDTH} {height}" role="img">{content}</svg>'
