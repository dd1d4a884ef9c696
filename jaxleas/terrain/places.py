"""Where a terrain lies: `--origin` moves it to where places are given."""

import logging
from pathlib import Path

import numpy as np
from jaxtyping import Float

from jaxleas.types import InputError

_LOG = logging.getLogger("jaxleas")
FARTHEST = 10_000.0
"""Distance from the origin within which starts and goals can be given [m]."""
AUTO = "auto"


def shift_of(
    path: str | Path, origin: str | None, low: tuple[float, float]
) -> Float[np.ndarray, " 3"]:
    """Return what is subtracted from the coordinates of a file [m]; it is said if it is found.

    Args:
        path: path of the file, for messages.
        origin: 'X,Y' or 'X,Y,Z' in metres of the file, 'auto', or None for no shift.
        low: smallest x and y of the terrain [m]; whole metres below them are the origin of 'auto'.

    Raises:
        InputError: the origin is neither.
    """
    if origin is None:
        return np.zeros(3)
    if origin == AUTO:
        x, y = np.floor(low)
        _LOG.warning("%s: its point %.0f,%.0f m becomes x = y = 0", path, x, y)
        return np.array([x, y, 0.0])
    try:
        numbers = [float(word) for word in origin.split(",")]
    except ValueError:
        numbers = []
    if len(numbers) not in (2, 3) or not np.isfinite(numbers).all():
        raise InputError(
            f"--origin {ascii(origin)[1:-1]:.60}: say the point of {path} that becomes x = y = 0 as"
            " X,Y or X,Y,Z in metres, or 'auto'"
        )
    return np.array([*numbers, 0.0][:3])


def require_near(path: str | Path, points: Float[np.ndarray, "*N 3"]) -> None:
    """Refuse a terrain so far away that no start or goal can be given on it.

    Args:
        path: path of the file, for messages.
        points: its corners, or those of its bounding box [m].

    Raises:
        InputError: it lies beyond 10 km; the message says what would do.
    """
    flat = np.reshape(points, (-1, points.shape[-1]))[:, :2]
    farthest = float(np.abs(flat).max())
    if farthest > FARTHEST:
        x, y = np.floor(flat.min(axis=0))
        raise InputError(
            f"{path} lies {farthest:.7g} m from the origin, and starts and goals lie within"
            f" {FARTHEST:g} m of it: say --origin auto, or --origin {x:.0f},{y:.0f}, the point that"
            " becomes x = y = 0"
        )
