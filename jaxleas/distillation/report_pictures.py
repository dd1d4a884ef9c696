"""Pictures of a distillation: rounds, calibration, and learning curves of P1 and P2."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from jaxleas.distillation.round_result import RoundResult
from jaxleas.reports import blank_picture, dress, png_of, series

if TYPE_CHECKING:
    from matplotlib.axes import Axes

DPI = 110
BLUE, RED, GREY = "#1f5fd0", "#c33d2e", "0.72"
CURVES = {
    "walk/reward": ("reward per step", 1.0),
    "held_out/reached": ("held-out links reached [%]", 100.0),
    "walk/failures_per_1000_steps": ("failures per 1000 steps", 1.0),
}
SMOOTH = 9  # updates over which a noisy curve is averaged


def draw_rounds(rounds: Sequence[RoundResult]) -> bytes:
    """Draw the exact success of every round: the mean, with thin lines for the cells behind it."""
    figure = blank_picture(6.4, 3.6)
    ax: Axes = figure.subplots()
    number = [row.round for row in rounds]
    for name in rounds[0].cells:
        ax.plot(number, [100 * row.cells[name] for row in rounds], color=GREY, linewidth=0.8)
    mean = [100 * row.success for row in rounds]
    ax.plot(number, mean, color=BLUE, marker="o", linewidth=2)
    _dress(ax, "round (0: the policy begun with)", "exact success [%]")
    ax.set_xticks(number)
    return png_of(figure, DPI)


def draw_calibration(report: Mapping[str, Any]) -> bytes:
    """Draw foreseen against observed failures, by stretch and by guide path."""
    figure = blank_picture(8.4, 3.8)
    for ax, name in zip(figure.subplots(1, 2), ("stretch", "guide"), strict=True):
        part = report[name]
        curve = np.maximum(np.array(part["curve"]), 0.0)
        least = max(1e-4, 0.5 / part["count"])
        foreseen, found = (np.maximum(curve[:, column], least) for column in (0, 1))
        ends = [min(foreseen.min(), found.min()), 1.0]
        ax.plot(ends, ends, color=GREY, linewidth=1)
        ax.loglog(foreseen, found, color=BLUE, marker="o", linewidth=1.2)
        error = 100 * part["calibration_error"]
        title = f"by {name}: {part['count']}, error {error:.2f} %"
        ax.set_title(title, loc="left", fontsize=10)
        _dress(ax, "probability of failure foreseen", "share that failed")
    return png_of(figure, DPI)


def draw_learning(
    start: Sequence[Mapping[str, Any]], practice: Sequence[Sequence[Mapping[str, Any]]]
) -> bytes:
    """Draw the first training and the practice of all rounds after it, on one axis of steps.

    Args:
        start: metrics of LEAS-P1; empty where they are not available.
        practice: metrics of each round.
    """
    figure = blank_picture(11.0, 3.4)
    axes = figure.subplots(1, len(CURVES))
    begins = start[-1]["step"] / 1e6 if start else 0.0
    for ax, (name, (label, factor)) in zip(axes, CURVES.items(), strict=True):
        _curve(ax, series(start, name, factor), 0.0, BLUE, "P1: conditions alone")
        offset = begins
        for number, rows in enumerate(practice):
            title = "P2: and the planner" if number == 0 else None
            _curve(ax, series(rows, name, factor), offset, RED, title)
            offset += rows[-1]["step"] / 1e6 if rows else 0.0
        _dress(ax, "environment steps [million]", label)
    handles, labels = axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=2, frameon=False, fontsize=9)
    return png_of(figure, DPI)


def _curve(
    ax: "Axes",
    curve: tuple[list[float], list[float]],
    offset: float,
    colour: str,
    label: str | None,
) -> None:
    steps, values = curve
    if len(values) > 3 * SMOOTH:
        values = np.convolve(values, np.ones(SMOOTH) / SMOOTH, mode="valid").tolist()
        steps = steps[SMOOTH // 2 :][: len(values)]
    ax.plot([offset + each for each in steps], values, color=colour, linewidth=1.3, label=label)


def _dress(ax: "Axes", x: str, y: str) -> None:
    ax.set(xlabel=x, ylabel=y)
    dress(ax)
