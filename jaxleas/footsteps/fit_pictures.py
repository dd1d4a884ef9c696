"""Figures 4.4 to 4.8 of the thesis: mean displacement and its spread by the speed commanded."""

from pathlib import Path

import numpy as np

from jaxleas.files import atomic_path
from jaxleas.footsteps.features import absolute_feet, com_labels
from jaxleas.footsteps.records import FootstepRecords
from jaxleas.types import MOVEMENTS

FIGURES: dict[str, str] = dict(zip(MOVEMENTS, ("4.4", "4.6", "4.5", "4.7", "4.8"), strict=True))
"""Figure of the thesis that shows a movement."""
_AXIS: dict[str, int] = dict(zip(MOVEMENTS, (0, 1, 1, 2, 2), strict=True))
"""Component of the command and of the displacement that a movement is about."""


def draw_displacements(records: FootstepRecords, folder: Path) -> list[Path]:
    """Draw the mean displacement of the centre of mass and of each foot, a file a movement.

    Turning shows the yaw of the trunk, and how far feet move in the plane.

    Args:
        records: footsteps.
        folder: folder for the pictures.

    Returns:
        The files written; movements without footsteps have none.
    """
    written = []
    for movement in MOVEMENTS:
        chosen = records.footsteps.movement == movement
        if chosen.any():
            path = folder / f"{movement}.png"
            _draw(records, movement, path)
            written.append(path)
    return written


def _draw(records: FootstepRecords, movement: str, path: Path) -> None:
    import matplotlib as mpl
    from matplotlib.figure import Figure

    steps = records.footsteps.at(records.footsteps.movement == movement)
    axis, controller = _AXIS[movement], records.controller
    speed = np.abs(steps.command[:, axis])
    com, feet = com_labels(steps)[:, axis], absolute_feet(steps)
    with mpl.rc_context({"font.size": 9}):
        figure = Figure(figsize=(9, 3.6), layout="constrained")
        trunk, foot_axes = figure.subplots(1, 2)
        for pair, name in enumerate(controller.pair_names):
            chosen = steps.pair == pair
            _curve(trunk, speed[chosen], com[chosen], name)
            for foot in controller.pairs[pair]:
                moved = feet[chosen, foot]
                length = np.linalg.norm(moved, axis=1) if axis == 2 else moved[:, axis]
                _curve(foot_axes, speed[chosen], length, controller.feet[foot])
        unit = "rad" if axis == 2 else "m"
        trunk.set(title="centre of mass", ylabel=f"displacement [{unit}]")
        foot_axes.set(title="swinging feet", ylabel="displacement [m]")
        for each in (trunk, foot_axes):
            each.set_xlabel(f"speed commanded [{unit}/s]")
            each.legend(title="swinging" if each is trunk else None, frameon=False)
        figure.suptitle(
            f"{movement}: mean and standard deviation (thesis, figure {FIGURES[movement]})"
        )
        with atomic_path(path) as temporary:
            figure.savefig(temporary, format="png", dpi=110)


def _curve(axes, speed: np.ndarray, displacement: np.ndarray, label: str) -> None:
    levels, index = np.unique(np.round(speed, 6), return_inverse=True)
    groups = [displacement[index == level] for level in range(len(levels))]
    means, spreads = [each.mean() for each in groups], [each.std() for each in groups]
    axes.errorbar(levels, means, spreads, label=label, capsize=2, marker="o", markersize=3)
