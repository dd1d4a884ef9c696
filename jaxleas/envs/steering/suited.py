"""What suits a robot of another size than Talos: its heights as seen from the root, its terrain."""

from typing import Any

from jaxleas.robots import known_robot
from jaxleas.terrain import PUBLISHED, GeneratorConfig, scale_for, scaled

LOWEST, HIGHEST = -1.4, -0.2
"""Bounds to which Talos's heights are clipped, relative to its root (T table 3.1) [m]."""


def suited_to(robot: str) -> dict[str, Any]:
    """Return values of a run's sections `env` and `terrain` that suit a robot; none for Talos.

    A robot whose file is not here has none either: a run folder, which states all values, can be
    read without it.

    Args:
        robot: name of the robot, or path of its file.
    """
    known = known_robot(robot)
    scale = PUBLISHED if known is None else scale_for(known)
    if scale == PUBLISHED:
        return {}
    low, high = (round(scale.leg * height, 3) for height in (LOWEST, HIGHEST))
    generator = scaled(GeneratorConfig(), scale).model_dump(mode="json")
    return {
        "env": {"height_low": low, "height_high": high},
        "terrain": {"generator": generator},
    }
