"""Top views of roll-outs in the style of T figures 3.14-3.17."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Bool, Float, Int

from jaxleas.evaluation import CellRollOut
from jaxleas.geometry import wrap_angle_on_host
from jaxleas.terrain import VOID_COLOUR, HeightMap, draw_height_map

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

REACHED, UNPLANNED, INVALID, STOPPED = "#ffd21f", "#e0359b", "#000000", "#ffffff"
PATH, GOAL, RING = "#1f5fd0", "#e02020", "#1f5fd0"
ARROW_SPACING, ARROW_TURN = 0.3, 1.0
"""Distance between two heading arrows along a path [m], and turn between them [rad]."""
ARROW_LENGTH = 0.15
"""Length of a heading arrow [inches], whatever the picture's scale."""
MOST_ARROWS = 25
"""Most arrows along one path: they must not hide a robot that dithers."""
BORDER = 0.12
"""Width of the void shown around the ground [m]."""


@dataclass(frozen=True)
class View:
    """What a top view shows.

    Attributes:
        title: title above the view.
        ground: height map of the terrain.
        roll_outs: roll-outs on that terrain, to one goal.
        examples: roll-outs that are drawn as paths.
        dots: number of roll-outs that are drawn as starts.
        radius: radius within which the goal counts as reached [m].
        planned: roll-outs that an exact planner found contacts for; None: not asked.
    """

    title: str
    ground: HeightMap
    roll_outs: CellRollOut
    examples: Sequence[int]
    dots: int
    radius: float
    planned: Bool[np.ndarray, " N"] | None = None


def choose_examples(roll_outs: CellRollOut, count: int, among: int) -> list[int]:
    """Return roll-outs that show a cell: starts spread out, one of each kind of failure first.

    Args:
        roll_outs: roll-outs of one scene.
        count: greatest number of roll-outs to return.
        among: number of first roll-outs to choose from.
    """
    horizontal = roll_outs.position[:among, 0, :2]
    stopped = (~roll_outs.reached & ~roll_outs.invalid)[:among]
    kinds = [flag for flag in (roll_outs.invalid[:among], stopped) if flag.any() and not flag.all()]
    chosen = [int(np.flatnonzero(flag)[0]) for flag in kinds][:count]
    if not chosen:
        chosen = [int(np.argmin(horizontal.sum(axis=1)))]
    while len(chosen) < min(count, len(horizontal)):
        # The start farthest from those chosen: a spread that needs no random numbers.
        gaps = np.linalg.norm(horizontal[:, None] - horizontal[None, chosen], axis=-1).min(axis=1)
        chosen.append(int(np.argmax(gaps)))
    return chosen


def draw_view(ax: "Axes", view: View) -> None:
    """Draw a top view: starts coloured by how each ended, the goal, example paths and headings."""
    draw_height_map(view.ground, ax=ax, colour_bar=False)
    ax.set_title(view.title, fontsize=10)
    roll_outs = view.roll_outs
    shown = np.arange(len(roll_outs.reached)) < view.dots
    start = roll_outs.position[:, 0, :2]
    planned = roll_outs.reached if view.planned is None else view.planned
    endings = (
        (planned, REACHED, "#5c4a00", 0.4),
        (roll_outs.reached & ~planned, UNPLANNED, "#ffffff", 0.3),
        (~roll_outs.reached & ~roll_outs.invalid, STOPPED, RING, 1.2),
        (roll_outs.invalid, INVALID, "#ffffff", 0.3),
    )
    for flag, colour, edge, width in endings:
        dots = start[flag & shown]
        ax.scatter(
            dots[:, 0], dots[:, 1], s=20, c=colour, edgecolors=edge, linewidths=width, zorder=3
        )
    for index in view.examples:
        _draw_path(ax, roll_outs, index)
    _draw_goals(ax, np.asarray(roll_outs.starts.waypoints)[view.examples[0]], view.radius)
    _crop(ax, view.ground, np.asarray(roll_outs.starts.waypoints)[view.examples[0]])
    ax.set(xlabel="", ylabel="")
    ax.tick_params(labelsize=7)


def _crop(ax: "Axes", ground: HeightMap, waypoints: Float[np.ndarray, "W 3"]) -> None:
    """Leave out the void around the ground, but keep any goal that lies in it."""
    rows, columns = np.nonzero(np.isfinite(ground.heights))
    x = np.concatenate([ground.origin[0] + ground.resolution * columns, waypoints[:, 0]])
    y = np.concatenate([ground.origin[1] + ground.resolution * rows, waypoints[:, 1]])
    ax.set_facecolor(VOID_COLOUR)
    ax.set_xlim(x.min() - BORDER, max(x.max(), waypoints[:, 0].max() + BORDER) + BORDER)
    ax.set_ylim(y.min() - BORDER, y.max() + BORDER)


def _draw_path(ax: "Axes", roll_outs: CellRollOut, index: int) -> None:
    path, yaw = roll_outs.path(index), roll_outs.yaw[index]
    ax.plot(path[:, 0], path[:, 1], color=PATH, linewidth=1.6, zorder=4)
    at = arrow_indices(path, yaw[: len(path)])
    ax.quiver(
        path[at, 0],
        path[at, 1],
        np.cos(yaw[at]),
        np.sin(yaw[at]),
        units="inches",
        scale=1.0 / ARROW_LENGTH,
        width=0.014,
        headwidth=4.5,
        headlength=5.0,
        headaxislength=4.5,
        color="black",
        zorder=5,
    )
    if roll_outs.invalid[index]:
        ax.plot(
            path[-1, 0], path[-1, 1], "x", color=GOAL, markersize=7, markeredgewidth=2, zorder=7
        )


def arrow_indices(
    path: Float[np.ndarray, "T 3"], yaw: Float[np.ndarray, " T"]
) -> Int[np.ndarray, " K"]:
    """Return where along a path arrows show its heading: evenly by distance and by turning."""
    moved = np.linalg.norm(np.diff(path[:, :2], axis=0), axis=1) / ARROW_SPACING
    turned = np.abs(wrap_angle_on_host(np.diff(yaw))) / ARROW_TURN
    travelled = np.concatenate([[0.0], np.cumsum(moved + turned)])
    spacing = max(1.0, travelled[-1] / MOST_ARROWS)
    wanted = np.arange(0.0, travelled[-1] + 1e-9, spacing)
    return np.unique(np.searchsorted(travelled, np.minimum(wanted, travelled[-1])))


def _draw_goals(ax: "Axes", waypoints: Float[np.ndarray, "W 3"], radius: float) -> None:
    from matplotlib.patches import Circle

    for order, (x, y, _) in enumerate(waypoints):
        ax.add_patch(Circle((x, y), radius, fill=False, color=GOAL, linewidth=1.0, zorder=6))
        ax.plot(x, y, "o", color=GOAL, markersize=4, zorder=6)
        if len(waypoints) > 1:
            ax.annotate(
                str(order + 1),
                (x, y),
                xytext=(7, 7),
                textcoords="offset points",
                color=GOAL,
                fontsize=10,
                fontweight="bold",
                zorder=8,
            )


def legend(figure: "Figure", planner: str | None = None) -> None:
    """Explain the colours of top views, and with a planner's name those of its answers."""
    from matplotlib.lines import Line2D

    def dot(colour: str, edge: str, label: str) -> Line2D:
        return Line2D([], [], marker="o", linestyle="", color=colour, mec=edge, label=label)

    handles = [
        dot(REACHED, "#5c4a00", f"start: {f'planned by {planner}' if planner else 'reached'}"),
        *([dot(UNPLANNED, UNPLANNED, "start: reached, not planned")] if planner else []),
        dot(STOPPED, RING, "start: stopped"),
        dot(INVALID, INVALID, "start: invalid"),
        dot(GOAL, GOAL, "goal"),
        Line2D([], [], color=PATH, linewidth=2, label="path, heading"),
        Line2D([], [], marker="x", linestyle="", color=GOAL, mew=2, label="invalid configuration"),
    ]
    figure.legend(
        handles=handles, loc="outside lower center", ncols=len(handles), frameon=False, fontsize=8
    )
