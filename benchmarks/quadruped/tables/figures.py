"""Figures 5.3, 5.5 and 5.7: ways and landings of one robot, predicted and walked."""

from pathlib import Path
from typing import Any

import numpy as np

from jaxleas.crossing import Course
from jaxleas.files import atomic_path
from jaxleas.footsteps import UNSAFE
from jaxleas.terrain import SceneEdges

Walk = list[dict[str, Any]]
"""Footsteps of one robot, as `walked.measure` returns them."""
PREDICTED, WALKED, NEAR = "#1a8a3a", "#1f5fbf", "#f2a29b"
GROUND = ("#85857d", "#f4f4f0")
"""Colours of the lowest and of the highest surface."""
FOOT_RADIUS = 0.031
"""Radius of the ball at the end of ANYmal B's legs, whose middle is measured [m]."""


def draw(course: Course, walk: Walk, path: Path) -> None:
    """Draw a walk from above and, below it, from its right side.

    Args:
        course: course that was crossed.
        walk: footsteps of the robot.
        path: file for the picture.
    """
    import matplotlib as mpl
    from matplotlib.figure import Figure

    corners = np.concatenate(list(course.scene.surfaces.values()))
    low, high = corners.min(axis=0), corners.max(axis=0)
    with mpl.rc_context({"font.size": 9}):
        width = 14.0
        tall = width * (high[1] - low[1]) / (high[0] - low[0])
        figure = Figure(figsize=(width, tall + 3.4), layout="constrained")
        above, beside = figure.subplots(2, 1, sharex=True, height_ratios=[tall, 1.8])
        _ground(above, course, low, high)
        _edges_from_the_side(beside, course)
        _way(above, walk)
        _landings(above, walk, 1, label=True)
        _landings(beside, walk, 2, label=False)
        beside.plot([each["com"][0] for each in walk], [each["com"][2] for each in walk], c=WALKED)
        above.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal", ylabel="y [m]")
        beside.set(xlabel="x [m]", ylabel="z [m]", ylim=(low[2] - 0.05, high[2] + 0.65))
        above.legend(loc="upper left", ncols=5, fontsize=8)
        with atomic_path(path) as temporary:
            figure.savefig(temporary, format="png", dpi=90, metadata={"Software": None})


def _ground(plot: Any, course: Course, low: np.ndarray, high: np.ndarray) -> None:
    """Draw surfaces, the higher the lighter, and what is too near an edge."""
    from matplotlib.colors import LinearSegmentedColormap
    from matplotlib.patches import Patch, Polygon

    colours = LinearSegmentedColormap.from_list("ground", GROUND)
    rise = max(high[2] - low[2], 1e-9)
    for surface in sorted(course.scene.surfaces.values(), key=lambda each: each[:, 2].mean()):
        share = (surface[:, 2].mean() - low[2]) / rise
        plot.add_patch(Polygon(surface[:, :2], color=colours(share), zorder=0))
    x, y = (np.arange(low[axis] + 0.0025, high[axis], 0.005) for axis in (0, 1))
    places = np.stack(np.meshgrid(x, y), axis=-1)
    away = SceneEdges.of(course.scene).distance(places.reshape(-1, 2)).reshape(places.shape[:2])
    shown = np.ma.masked_where(away >= UNSAFE, np.ones_like(away))
    plot.imshow(
        shown,
        origin="lower",
        extent=(low[0], high[0], low[1], high[1]),
        cmap=LinearSegmentedColormap.from_list("near", [NEAR, NEAR]),
        interpolation="nearest",
        zorder=1,
    )
    plot.add_artist(plot.legend(handles=[Patch(color=NEAR, label="unsafe")], loc="lower left"))


def _edges_from_the_side(plot: Any, course: Course) -> None:
    for surface in course.scene.surfaces.values():
        x, z = surface[:, 0], surface[:, 2]
        plot.plot([x.min(), x.max()], [z[x.argmin()], z[x.argmax()]], c="#555555", lw=1.2)


def _way(plot: Any, walk: Walk) -> None:
    com = np.array([each["com"] for each in walk])
    plot.plot(com[:, 0], com[:, 1], c=WALKED, lw=1.2, label="centre of mass")
    planned = np.array([each["planned"]["com"] for each in walk if each["planned"]])
    plot.plot(planned[:, 0], planned[:, 1], ".", c=PREDICTED, ms=4, label="predicted")


def _landings(plot: Any, walk: Walk, axis: int, label: bool) -> None:
    """Draw where feet landed and where they were predicted, from above or from the side.

    Args:
        plot: plot.
        walk: footsteps.
        axis: axis that is drawn upwards: 1 is y, 2 is z.
        label: whether the legend names them.
    """
    feet = np.concatenate([each["feet"] for each in walk]) - [0.0, 0.0, FOOT_RADIUS]
    predicted = np.concatenate([each["planned"]["feet"] for each in walk if each["planned"]])
    names = ("landing", "predicted landing") if label else (None, None)
    style = {"ls": "", "ms": 5, "mew": 0.9}
    plot.plot(
        predicted[:, 0], predicted[:, axis], "o", mfc="none", c=PREDICTED, label=names[1], **style
    )
    plot.plot(feet[:, 0], feet[:, axis], "x", c=WALKED, label=names[0], **style)
