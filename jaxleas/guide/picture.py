"""A top view of guide paths in the style of T figures 3.14-3.17."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from jaxleas.guide.files import Reason
from jaxleas.terrain import HeightMap, require_picture, save_picture
from jaxleas.types import GuidePath, Query

if TYPE_CHECKING:
    from matplotlib.axes import Axes

STARTS: dict[Reason, str] = {"reached": "gold", "invalid": "black", "stopped": "white"}
PATH, GOAL = "tab:blue", "red"
ARROWS_EVERY = 15  # configurations between two arrows
ARROW_LENGTH = 0.2  # [m]
MOST_PATHS = 200  # more paths would hide each other


def draw_navigation(
    path: str | Path,
    terrain: HeightMap,
    guide_path: GuidePath,
    waypoints: np.ndarray,
    goal: tuple[float, float],
) -> None:
    """Draw one path (blue), its headings, its numbered waypoints and the goal over the terrain.

    Args:
        path: file of the picture (.png, .svg, .pdf).
        terrain: height map under the path.
        guide_path: guide path that was found.
        waypoints: waypoints of the path, in order [m].
        goal: goal of the path, x and y [m].

    Raises:
        InputError: the picture cannot be written, or is of an unknown type.
    """
    from jaxleas.terrain import draw_height_map

    require_picture(path)
    ax = draw_height_map(terrain)
    plot_navigation(ax, guide_path, waypoints, goal)
    save_picture(ax, Path(path))


def plot_navigation(
    ax: "Axes", guide_path: GuidePath, waypoints: np.ndarray, goal: tuple[float, float]
) -> None:
    """Draw a path, its headings, its numbered waypoints and the goal on axes."""
    ax.plot(*guide_path.position[:, :2].T, color=PATH, linewidth=1.6, zorder=3)
    _draw_headings(ax, guide_path)
    ax.scatter(*guide_path.position[0, :2], s=40, c="gold", edgecolors="black", zorder=5)
    ax.scatter(*goal, s=40, c=GOAL, edgecolors="black", linewidths=0.5, zorder=6)
    for number, place in enumerate(waypoints, start=1):
        if not np.allclose(place, goal):
            ax.scatter(*place, s=22, c="white", edgecolors=PATH, zorder=5)
            ax.annotate(
                str(number), place, xytext=(5, 5), textcoords="offset points", color=PATH, zorder=7
            )


def _draw_headings(ax: "Axes", guide_path: GuidePath) -> None:
    at = slice(0, None, ARROWS_EVERY)
    ax.quiver(
        *guide_path.position[at, :2].T,
        np.cos(guide_path.yaw[at]),
        np.sin(guide_path.yaw[at]),
        angles="xy",
        scale_units="xy",
        scale=1.0 / ARROW_LENGTH,
        width=0.004,
        zorder=4,
    )


def draw_guide_paths(
    path: str | Path,
    terrain: HeightMap,
    guide_paths: Sequence[GuidePath],
    reasons: Sequence[Reason],
    queries: Sequence[Query],
) -> None:
    """Draw paths (blue), headings (arrows), goals (red) and starts by reason over the terrain.

    Args:
        path: file of the picture (.png, .svg, .pdf).
        terrain: height map under the paths.
        guide_paths: one guide path for each query; the first 200 are drawn.
        reasons: reason why each path ended.
        queries: queries with the goals of the paths.

    Raises:
        InputError: the picture cannot be written, or is of an unknown type.
    """
    from jaxleas.terrain import draw_height_map

    require_picture(path)
    ax = draw_height_map(terrain)
    shown = list(zip(guide_paths, reasons, queries, strict=True))[:MOST_PATHS]
    for guide_path, _, _ in shown:
        ax.plot(*guide_path.position[:, :2].T, color=PATH, linewidth=1.2, zorder=3)
        _draw_headings(ax, guide_path)
    for reason, colour in STARTS.items():
        starts = [query.position[:2] for _, each, query in shown if each == reason]
        if starts:
            x, y = np.array(starts).T
            ax.scatter(
                x, y, s=26, c=colour, edgecolors="black", linewidths=0.7, label=reason, zorder=5
            )
    goals = np.array([query.goal for _, _, query in shown])
    ax.scatter(*goals.T, s=30, c=GOAL, edgecolors="black", linewidths=0.5, label="goal", zorder=6)
    x_min, x_max, y_min, y_max = terrain.extent
    ax.set(xlim=(x_min, x_max), ylim=(y_min, y_max))  # a goal off the map is not shown
    ax.legend(loc="upper right", fontsize="small", framealpha=0.9)
    save_picture(ax, Path(path))
