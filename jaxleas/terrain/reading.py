"""How a terrain file is read: what the file itself does not state, and what is done with it."""

from dataclasses import dataclass, fields
from pathlib import Path
from typing import Literal

from jaxleas.types import InputError

Up = Literal["x", "y", "z"]
Rectangle = tuple[float, float, float, float]
"""x_min, x_max, y_min, y_max [m]."""


@dataclass(frozen=True)
class Reading:
    """What a terrain file does not state itself, and what is done with it.

    Attributes:
        resolution: edge of a cell [m]; 0.04 by default, needed for images and tables.
        up: axis of a mesh that points up; z by default, y of a .glb.
        scale: metres per unit of a mesh or of the heights in a table.
        z_min: height that black stands for in an image [m].
        z_max: height that white stands for in an image [m].
        zero_is_void: whether black in an image means no ground.
        origin: point of the file that becomes x = y = 0, as X,Y or X,Y,Z [m]; auto takes whole
            metres at the lower left corner.
        crop: bounds of the part that is kept, X_MIN X_MAX Y_MIN Y_MAX [m].
        fill: largest width of holes that are filled from their rims [m].
        smooth: standard deviation of the Gaussian by which heights are smoothed [m].
        topic: topic of the map in a bag; needed if there are several.
        layer: layer of the map in a bag; elevation by default.
    """

    resolution: float | None = None
    up: Up | None = None
    scale: float = 1.0
    z_min: float | None = None
    z_max: float | None = None
    zero_is_void: bool = False
    origin: str | None = None
    crop: Rectangle | None = None
    fill: float | None = None
    smooth: float | None = None
    topic: str | None = None
    layer: str | None = None


READING = Reading()
"""Everything as it is by default."""
SHAPING = ("origin", "crop")
"""What applies to every terrain, as a map or as polygons."""
MAPPING = ("resolution", "fill", "smooth", *SHAPING)
"""What applies to whatever becomes a height map."""


def require_applicable(
    path: str | Path, reading: Reading, options: tuple[str, ...], title: str
) -> None:
    """Refuse values that do not apply to a file, rather than ignore them.

    Args:
        path: path of the file, for the message.
        reading: values that were given.
        options: names of those that apply.
        title: kind of the file, for the message.

    Raises:
        InputError: a value was given that does not apply; the message names it, and what does.
    """
    given = [
        each.name
        for each in fields(reading)
        if getattr(reading, each.name) != each.default and each.name not in options
    ]
    if given:
        names = " and ".join(map(_option, given))
        verb = "do" if len(given) > 1 else "does"
        raise InputError(
            f"{names} {verb} not apply to {path}, {title}; what applies is"
            f" {', '.join(map(_option, options))}"
        )


def _option(name: str) -> str:
    return "--" + name.replace("_", "-")
