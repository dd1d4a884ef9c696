"""A picture of a robot as its file holds it: trunk, legs and ranges of motion."""

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial import ConvexHull

from jaxleas.robots import Robot
from jaxleas.terrain import save_picture

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_VIEWS = (
    ("from the side", 0, 2, "x [m]"),
    ("from the front", 1, 2, "y [m]"),
    ("from above", 0, 1, "x [m]"),
)
_COLOURS = ("#1f77b4", "#d62728", "#2ca02c", "#9467bd", "#ff7f0e", "#8c564b")


def draw_robot(robot: Robot, path: Path) -> None:
    """Draw a robot from the side, from the front and from above.

    Args:
        robot: robot.
        path: file of the picture.

    Raises:
        InputError: the picture cannot be written, or is of an unknown type.
    """
    from matplotlib.figure import Figure  # not pyplot: no global state, no window, no backend

    figure = Figure(figsize=(15.0, 5.6), layout="constrained")
    views = figure.subplots(1, len(_VIEWS))
    for ax, (title, across, along, label) in zip(views, _VIEWS, strict=True):
        _draw(ax, robot, across, along)
        ax.set(title=title, xlabel=label, ylabel="z [m]" if along == 2 else "y [m]", aspect="equal")
        if along == 2:
            ax.axhline(-robot.root_height, color="0.4", linewidth=1.0)
            ax.axhline(-robot.walking_height, color="0.4", linewidth=1.0, linestyle=":")
    views[0].legend(loc="upper right", fontsize="small", framealpha=0.9)
    figure.suptitle(
        f"{robot.name}: {robot.mass:g} kg, root {robot.root_height:g} m high, walking at"
        f" {robot.walking_height:g} m (dotted)"
    )
    save_picture(views[0], path)


def _draw(ax: "Axes", robot: Robot, across: int, along: int) -> None:
    """Draw one view into axes."""
    from matplotlib.patches import Rectangle

    for box in robot.trunk:
        low, high = np.array(box.low), np.array(box.high)
        size = high - low
        ax.add_patch(
            Rectangle((low[across], low[along]), size[across], size[along], color="0.6", alpha=0.4)
        )
    for index, (limb, place) in enumerate(zip(robot.limbs, robot.references, strict=True)):
        colour = _COLOURS[index % len(_COLOURS)]
        corners = limb.range_of_motion.vertices[:, [across, along]]
        outline = corners[ConvexHull(corners).vertices]
        ax.fill(*outline.T, facecolor=colour, alpha=0.15, edgecolor=colour, label=limb.name)
        if limb.model is not None:
            posture = limb.model.posture(limb.model.reference)
            line = np.vstack([np.zeros((1, 3)), posture.origins, posture.tip[None]])
            ax.plot(line[:, across], line[:, along], color=colour, marker="o", markersize=3)
        ax.plot(place[across], place[along], color=colour, marker="s", markersize=5)
