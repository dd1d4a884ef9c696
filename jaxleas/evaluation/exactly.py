"""Roll-outs on height maps, judged once more on the polygons of their scenes."""

from dataclasses import replace

import numpy as np
from jaxtyping import Bool

from jaxleas.conditions import EXACT_TWINS, STANDARD
from jaxleas.evaluation.roll_outs import CellRollOut
from jaxleas.evaluation.suites import Cell
from jaxleas.robots import Robot


def judged_exactly(robot: Robot, cell: Cell, walked: CellRollOut) -> CellRollOut:
    """Return roll-outs that end, invalid, where the polygons refuse what the map allowed (R*, C).

    What the height map refused stays refused. Roll-outs of a cell that is not to be judged exactly
    are returned as they are.

    Args:
        robot: robot that walks.
        cell: cell that was walked.
        walked: roll-outs of the cell.
    """
    if not cell.exactly:
        return walked
    refused = np.zeros_like(walked.valid)
    taken = np.arange(walked.valid.shape[1]) <= walked.end[:, None]
    for index, scenario in enumerate(cell.scenarios):
        rows = taken & (walked.starts.scene == index)[:, None]
        position, yaw = walked.position[rows], walked.yaw[rows]
        holds = [EXACT_TWINS[name](robot, scenario.scene, position, yaw) for name in STANDARD]
        refused[rows] = ~np.logical_and.reduce(holds)
    return _ended(walked, refused)


def _ended(walked: CellRollOut, refused: Bool[np.ndarray, "N T+1"]) -> CellRollOut:
    """Return roll-outs that end at the first refused configuration."""
    stopped = refused.any(axis=1)
    end = np.where(stopped, np.argmax(refused, axis=1), walked.end)
    return replace(
        walked,
        valid=walked.valid & ~refused,
        end=end,
        reached=walked.reached & ~stopped,
        invalid=walked.invalid | stopped,
        refused=None if walked.refused is None else walked.refused & ~stopped,
    )
