"""Learning curves from a run's metrics."""

from collections.abc import Mapping, Sequence
from typing import Any

from jaxleas.reports.picture import blank_picture, dress, png_of

DPI = 120
COLOURS = ("#1f5fd0", "#c33d2e", "#2e8b57", "#8a5fb0", "#b8860b")
# Panel title -> (unit, {metric: label}); the first names are the most important for the reader.
PANELS: dict[str, tuple[str, dict[str, str]]] = {
    "Held-out links": (
        "% of starts",
        {
            "held_out/reached": "reached",
            "held_out/invalid": "invalid",
            "held_out/stopped": "stopped",
        },
    ),
    "Reward": ("per step", {"walk/reward": "reward"}),
    "Events": (
        "per 1000 steps",
        {
            "walk/failures_per_1000_steps": "invalid configurations",
            "walk/goals_per_1000_steps": "goals reached",
        },
    ),
    "Losses": (
        "",
        {
            "learn/policy_loss": "policy",
            "learn/v_loss": "value",
            "learn/entropy_loss": "entropy",
        },
    ),
}


def series(
    rows: Sequence[Mapping[str, Any]], name: str, factor: float = 1.0
) -> tuple[list[float], list[float]]:
    """Return steps and values of a metric, where it was logged."""
    logged = [row for row in rows if row.get(name) is not None]
    return [row["step"] / 1e6 for row in logged], [factor * row[name] for row in logged]


def draw_learning_curves(rows: Sequence[Mapping[str, Any]]) -> bytes:
    """Draw the learning curves of a run and return them as a PNG.

    Args:
        rows: rows of `metrics.jsonl`.
    """
    figure = blank_picture(11.2, 5.6)
    for ax, (title, (unit, names)) in zip(figure.subplots(2, 2).flat, PANELS.items(), strict=True):
        percent = unit.startswith("%")
        for colour, (name, label) in zip(COLOURS, names.items(), strict=False):
            steps, values = series(rows, name, 100.0 if percent else 1.0)
            marker = "o" if percent else None
            ax.plot(steps, values, color=colour, label=label, linewidth=1.4, marker=marker, ms=3)
        ax.set_title(title, loc="left", fontsize=10, fontweight="bold")
        ax.set(xlabel="environment steps [million]", ylabel=unit)
        if percent:
            ax.set_ylim(-2.0, 102.0)
        ax.set_xlim(left=0.0)
        dress(ax)
        if len(names) > 1:
            ax.legend(frameon=False, fontsize=8)
    return png_of(figure, DPI)
