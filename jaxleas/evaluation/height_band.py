"""Root heights along a path, over the guide paths that reached the goal."""

import numpy as np

from jaxleas.evaluation.exact_answers import Judged


def height_band(judged: Judged, along: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return lowest, mean and highest root height at each x, of the paths that reached the goal.

    Args:
        judged: roll-outs and verdicts of a cell.
        along: x [m], ascending; the result is NaN where fewer than half of the paths pass.
    """
    heights = []
    for index in np.flatnonzero(judged.roll_outs.reached):
        path = judged.roll_outs.path(int(index)).astype(np.float64)
        x = np.maximum.accumulate(path[:, 0])
        heights.append(np.interp(along, x, path[:, 2], left=np.nan, right=np.nan))
    if not heights:
        nothing = np.full(len(along), np.nan)
        return nothing, nothing, nothing
    stack = np.array(heights)
    there = np.isfinite(stack).mean(axis=0) >= 0.5
    band = np.full((3, len(along)), np.nan)
    for row, function in enumerate((np.nanmin, np.nanmean, np.nanmax)):
        band[row, there] = function(stack[:, there], axis=0)
    return band[0], band[1], band[2]
