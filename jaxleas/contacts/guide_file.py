"""Guide paths, read from their file by its documented format (docs/files.md)."""

from pathlib import Path

import numpy as np

from jaxleas.files import read_npz, require_version_array
from jaxleas.types import GuidePath, InputError

NEEDED = ("time", "position", "yaw", "velocity", "valid")


def read_guide_path(path: str | Path, query: int = 0) -> GuidePath:
    """Return one guide path of a file.

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
    return GuidePath(
        time=arrays["time"][mine],
        position=arrays["position"][mine].astype(np.float64),
        yaw=arrays["yaw"][mine].astype(np.float64),
        velocity=arrays["velocity"][mine],
        valid=arrays["valid"][mine].astype(bool),
    )
