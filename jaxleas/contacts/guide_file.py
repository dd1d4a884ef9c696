"""Guide paths, read from their file by its documented format (docs/files.md)."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from jaxleas.files import read_npz, require_version_array
from jaxleas.robots import RecordedRobot
from jaxleas.types import Ending, GuidePath, InputError, ending_of

NEEDED = ("time", "position", "yaw", "velocity", "valid")


@dataclass(frozen=True, eq=False)
class RecordedGuide:
    """One guide path of a file.

    Attributes:
        guide: guide path.
        ending: how it ended.
        robot: robot that walked it; None in files from before robots were recorded.
    """

    guide: GuidePath
    ending: Ending
    robot: RecordedRobot | None


def read_guide_path(path: str | Path, query: int = 0) -> GuidePath:
    """Return one guide path of a file.

    Args:
        path: the .npz file.
        query: number of the path in the file, counted from 0.

    Raises:
        InputError: the file cannot be used, or has no such path.
    """
    return read_recorded_guide(path, query).guide


def read_recorded_guide(path: str | Path, query: int = 0) -> RecordedGuide:
    """Return one guide path of a file, with how it ended and who walked it.

    Args:
        path: the .npz file.
        query: number of the path in the file, counted from 0.

    Raises:
        InputError: the file cannot be used, or has no such path.
    """
    arrays = read_npz(path, NEEDED)
    require_version_array(arrays, 1, path)
    rows = len(arrays["time"]) if arrays["time"].ndim == 1 else 0
    owner = arrays.get("query", np.zeros(rows, np.int64))
    for name in (*NEEDED, "query"):
        array = owner if name == "query" else arrays[name]
        shape = (rows, 3) if name in ("position", "velocity") else (rows,)
        if rows == 0 or array.shape != shape or array.dtype.kind not in "fiub":
            raise InputError(
                f"{path}: {name} has shape {array.shape}, where {rows} rows need {shape}"
            )
        if not np.isfinite(array).all():
            raise InputError(f"{path}: {name} holds a number that is not finite (NaN or infinity)")
    mine = owner == query
    if not mine.any():
        raise InputError(f"{path} has no path {query}; it holds paths 0 to {int(owner.max())}")
    guide = GuidePath(
        time=arrays["time"][mine],
        position=arrays["position"][mine].astype(np.float64),
        yaw=arrays["yaw"][mine].astype(np.float64),
        velocity=arrays["velocity"][mine],
        valid=arrays["valid"][mine].astype(bool),
    )
    reasons = arrays.get("reason", np.array([], np.str_))
    said = str(reasons[query]) if reasons.ndim == 1 and query < len(reasons) else ""
    return RecordedGuide(guide, ending_of(guide, said), RecordedRobot.from_arrays(arrays, path))
