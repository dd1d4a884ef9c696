"""The kinds of files with heights, one line each: whatever lists or reads them looks here."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from jaxleas.terrain.height_map import HeightMap, read_height_map
from jaxleas.terrain.rasters.ascii_grids import read_asc
from jaxleas.terrain.rasters.foreign_rasters import read_grid_map, read_tiff
from jaxleas.terrain.rasters.images import read_png
from jaxleas.terrain.rasters.tables import read_csv, read_npy
from jaxleas.terrain.reading import MAPPING, Reading
from jaxleas.types import InputError

_GREY = ("z_min", "z_max", "zero_is_void")


@dataclass(frozen=True)
class MapFormat:
    """A kind of file with heights.

    Attributes:
        title: what it is, for messages.
        read: reader of the map, where the file places it.
        options: names of the options that apply.
    """

    title: str
    read: Callable[[Path, Reading], HeightMap]
    options: tuple[str, ...] = MAPPING


def read_npz(path: Path, reading: Reading) -> HeightMap:
    """Return the map of a .npz file, whose cells must be those of `reading`."""
    found = read_height_map(path)
    if reading.resolution is not None and not np.isclose(reading.resolution, found.resolution):
        raise InputError(
            f"{path} is a map of {found.resolution:g} m cells; "
            f"it cannot be read at a resolution of {reading.resolution:g} m"
        )
    return found


_IMAGE = MapFormat("a TIFF", read_tiff, (*MAPPING, "scale", *_GREY))
_BAG = MapFormat("a bag with a GridMap", read_grid_map, (*MAPPING, "topic", "layer"))
MAPS: dict[str, MapFormat] = {
    ".npz": MapFormat("a height map", read_npz),
    ".png": MapFormat("an image", read_png, (*MAPPING, *_GREY)),
    ".tif": _IMAGE,
    ".tiff": _IMAGE,
    ".npy": MapFormat("a table of heights", read_npy, (*MAPPING, "scale")),
    ".csv": MapFormat("a table of heights", read_csv, (*MAPPING, "scale")),
    ".txt": MapFormat("a table of heights", read_csv, (*MAPPING, "scale")),
    ".asc": MapFormat("an ESRI ASCII grid", read_asc, (*MAPPING, "scale")),
    ".bag": _BAG,
    ".mcap": _BAG,
    ".db3": _BAG,
}
