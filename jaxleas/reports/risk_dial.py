"""The picture of the risk dial."""

from collections.abc import Mapping, Sequence
from typing import Any

from jaxleas.reports.picture import blank_picture, dress, png_of

DPI = 110


def draw_dial(curves: Mapping[str, Sequence[Mapping[str, Any]]], title: str) -> bytes:
    """Draw exact success against the share attempted, and against speed, as a PNG.

    Args:
        curves: settings as `as_json` gives them, by the name of what was walked.
        title: title above the picture.
    """
    figure = blank_picture(10.4, 4.2)
    axes = figure.subplots(1, 3)
    for name, settings in curves.items():
        there = [each for each in settings if each["success"] is not None]
        at = [each["threshold"] for each in there]
        success = [100.0 * each["success"] for each in there]
        attempted = [100.0 * each["attempted"] for each in there]
        (line,) = axes[0].plot(at, success, marker=".", label=name)
        band = [[100.0 * each[end] for each in there] for end in ("low", "high")]
        axes[0].fill_between(at, *band, color=line.get_color(), alpha=0.12, linewidth=0)
        axes[1].plot(attempted, success, marker=".", color=line.get_color())
        axes[2].plot(
            [100.0 * each["speed"] for each in there], success, ".-", color=line.get_color()
        )
    labels = ("threshold", "starts attempted [%]", "mean speed of the root [cm/s]")
    for ax, label in zip(axes, labels, strict=True):
        ax.set(xlabel=label, ylabel="exact success of those attempted [%]")
        dress(ax)
    axes[0].legend(frameon=False, fontsize=8, loc="lower right")
    figure.suptitle(title, fontsize=11)
    return png_of(figure, DPI)
