"""What counts as a surface when planes are sought in a height map."""

from dataclasses import dataclass, fields

from jaxleas.types import InputError

STEEPEST = 60.0
"""Slope beyond which a scene lets no foot stand on a surface [deg]."""


@dataclass(frozen=True)
class PlaneSearch:
    """What counts as a surface in a height map; lengths in metres.

    Attributes:
        max_slope: steepest slope on which feet may stand [deg].
        min_area: smallest area of a surface [m^2].
        roughness: largest root mean square distance of a surface's cells from its plane [m].
        noise: standard deviation of the map's heights [m]; by default it is measured on the map.
        inset: distance by which surfaces are shrunk from their edges [m]; by default half a cell
            plus the noise, since edges are not known better; half a foot keeps whole soles on them.
        closing: largest width of holes without heights that a surface closes [m]; a hole stays open
            where something stands out of the surface by more than the noise.
    """

    max_slope: float = 45.0
    min_area: float = 0.02
    roughness: float = 0.02
    noise: float | None = None
    inset: float | None = None
    closing: float = 0.06

    def __post_init__(self) -> None:
        """Refuse numbers out of range.

        Raises:
            InputError: a number is out of range; the message names it as an option.
        """
        for each in fields(self):
            value, (low, high) = getattr(self, each.name), _RANGES[each.name]
            if value is not None and not low <= value <= high:
                option = each.name.replace("_", "-")
                raise InputError(f"--{option} {value:g} must be from {low:g} to {high:g}")

    @property
    def given(self) -> tuple[str, ...]:
        """Names of the values that are not as they are by default."""
        return tuple(each.name for each in fields(self) if getattr(self, each.name) != each.default)


_RANGES = {
    "max_slope": (0.0, STEEPEST),
    "min_area": (0.0, 1e4),
    "roughness": (0.0, 1.0),
    "noise": (0.0, 1.0),
    "inset": (0.0, 1.0),
    "closing": (0.0, 10.0),
}
PLANE_SEARCH = PlaneSearch()
"""Everything as it is by default."""
