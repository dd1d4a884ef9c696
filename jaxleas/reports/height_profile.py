"""The height profile of a roll-out as in T figure 3.15: ground, root, reach of the legs."""

from typing import TYPE_CHECKING

import numpy as np

from jaxleas.evaluation import CellRollOut
from jaxleas.reports.top_view import GOAL, PATH
from jaxleas.robots import Robot
from jaxleas.terrain import HeightMap
from jaxleas.types import is_ground

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def draw_profile(
    ax: "Axes", robot: Robot, ground: HeightMap, roll_outs: CellRollOut, index: int, title: str
) -> None:
    """Draw the height profile of one path: the ground below it, the root, and the legs' reach.

    The band is the legs' range of motion straight below the root; R* requires ground in it
    somewhere within 0.1 m, C that the ground stays below the trunk's underside.

    Args:
        ax: axes to draw on.
        robot: robot whose legs and trunk are drawn.
        ground: height map of the terrain.
        roll_outs: roll-outs on the terrain.
        index: index of the roll-out to draw.
        title: title above the picture.
    """
    path = roll_outs.path(index)
    moved = np.linalg.norm(np.diff(path[:, :2], axis=0), axis=1)
    distance = np.concatenate([[0.0], np.cumsum(moved)])
    low, high = reach_below_root(robot)
    underside = min(float(box.low[2]) for box in robot.trunk)
    # Finer than the guide path, so that risers are drawn upright.
    fine = np.linspace(0.0, distance[-1], 1 + 4 * len(path))
    x, y, root = (np.interp(fine, distance, path[:, axis]) for axis in range(3))
    height = ground.height_at(np.column_stack([x, y])).astype(np.float64)
    distance = fine
    floor = float(np.nanmin(height)) - 0.25
    solid = np.where(is_ground(height), height, floor)

    ax.fill_between(distance, floor, solid, color="0.55", linewidth=0, label="ground")
    ax.fill_between(
        distance, root + low, root + high, color="#2e9e4f", alpha=0.3, linewidth=0,
        label="within reach of the legs",
    )  # fmt: skip
    ax.plot(distance, root + underside, color=GOAL, linewidth=1, label="underside of the trunk")
    ax.plot(distance, root, color=PATH, linewidth=2, label="root")
    ax.set_title(title, fontsize=9)
    ax.set(xlabel="distance along the path [m]", ylabel="height [m]", ylim=(floor, None))
    ax.margins(x=0.0)
    ax.tick_params(labelsize=7)
    ax.grid(color="0.9", linewidth=0.5)
    ax.set_axisbelow(True)


def reach_below_root(robot: Robot) -> tuple[float, float]:
    """Return the lowest and highest effector position straight below the root [m], any limb's."""
    under = np.array([[0.0, side * 0.05] for side in (-1, 0, 1)])
    intervals = [limb.range_of_motion.z_interval(under) for limb in robot.legs]
    low = min(float(np.nanmin(each[0])) for each in intervals)
    high = max(float(np.nanmax(each[1])) for each in intervals)
    return low, high
