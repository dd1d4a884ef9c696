"""How a terrain file is read: what the file itself does not state."""

from dataclasses import dataclass
from typing import Literal

Up = Literal["x", "y", "z"]


@dataclass(frozen=True)
class Reading:
    """What a terrain file does not state itself.

    Attributes:
        resolution: edge of a cell [m]; 0.04 by default, needed for .png.
        up: axis of a mesh that points up.
        scale: metres per unit of a mesh.
        z_min: height of black in a .png [m].
        z_max: height of white in a .png [m].
        zero_is_void: whether black in a .png means no ground.
    """

    resolution: float | None = None
    up: Up = "z"
    scale: float = 1.0
    z_min: float | None = None
    z_max: float | None = None
    zero_is_void: bool = False


READING = Reading()
"""Everything as it is by default."""
