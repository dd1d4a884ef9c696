"""Numbers in the JSON of a contact problem, each refused by one sentence."""

import math
from typing import Any

import numpy as np

from jaxleas.types import InputError

OTHER_ROTATIONS = ("rotation", "orientation", "quaternion", "roll", "pitch", "rpy", "R")
MAX_COORDINATE = 1e6  # [m]


def vector(where: str, content: Any) -> np.ndarray:
    """Return three finite numbers [m]."""
    if (
        not isinstance(content, list)
        or len(content) != 3
        or any(isinstance(x, bool) or not isinstance(x, int | float) for x in content)
    ):
        raise InputError(f"{where} must be three numbers [x, y, z] in metres, not {content!r:.60}")
    if not all(abs(x) < MAX_COORDINATE for x in content):
        raise InputError(f"{where} {content!r:.60} is not finite, or beyond 1000 km")
    return np.array(content, dtype=np.float64)


def heading(where: str, content: Any) -> float:
    """Return a yaw of at most a full turn [rad]."""
    if not is_number(content):
        raise InputError(
            f"{where}: yaw must be one finite number of radians, not {content!r:.60}; rotations"
            " are about the vertical only"
        )
    if abs(content) > 2 * math.pi:
        raise InputError(f"{where}: yaw {content:g} is beyond a full turn; give radians")
    return float(content)


def is_number(content: Any) -> bool:
    """Return whether the content is a finite number, and no integer too large to be a float."""
    plain = isinstance(content, int | float) and not isinstance(content, bool)
    return plain and abs(content) < 1e300


def refuse_other_rotations(where: str, content: dict[str, Any]) -> None:
    """Refuse a rotation that would otherwise be ignored, as comments are."""
    for key in OTHER_ROTATIONS:
        if key in content:
            raise InputError(
                f"{where}: '{key}' is not read; rotations are about the vertical only: give yaw, in"
                " radians"
            )
