"""The user's own terrain files, which a configuration names."""

from collections.abc import Sequence
from dataclasses import fields
from pathlib import Path
from typing import Annotated, Any

from pydantic import Discriminator, Field, PositiveFloat, Tag

from jaxleas.configuration import Strict
from jaxleas.files import digest_of, require_digest
from jaxleas.terrain.height_map import HeightMap
from jaxleas.terrain.importers import import_terrain
from jaxleas.terrain.reading import Reading, Rectangle, Up
from jaxleas.types import InputError

KEY = "terrain.files"  # name of the configuration field, for messages


class TerrainFile(Strict):
    """A terrain file, with the values that the file does not state itself."""

    file: Annotated[str, Field(min_length=1)]
    """height map, scene, mesh, image, table or bag; found from the working folder"""
    up: Up | None = None
    """axis of a mesh that points up; z by default, y of a .glb"""
    scale: PositiveFloat = 1.0
    """metres per unit of a mesh or of the heights in a table"""
    z_min: float | None = None
    """height of black in an image [m]"""
    z_max: float | None = None
    """height of white in an image [m]"""
    zero_is_void: bool = False
    """whether black in an image means that there is no ground"""
    origin: str | None = None
    """point of the file that becomes x = y = 0, as X,Y or X,Y,Z [m], or auto"""
    crop: Rectangle | None = None
    """x_min, x_max, y_min, y_max of the part that is kept [m]"""
    fill: PositiveFloat | None = None
    """largest width of holes that are filled from their rims [m]"""
    smooth: PositiveFloat | None = None
    """standard deviation of the Gaussian that heights are averaged with [m]"""
    topic: str | None = None
    """topic of the map in a bag"""
    layer: str | None = None
    """layer of the map in a bag; elevation by default"""
    sha256: str | None = None
    """digest of the file, recorded when a run begins"""

    def reading(self, resolution: float) -> Reading:
        """Return how the file is read, in cells of this edge [m]."""
        stated = {each.name: getattr(self, each.name) for each in fields(Reading)[1:]}
        return Reading(resolution, **stated)


def _kind(value: Any) -> str:
    return "file" if isinstance(value, dict | TerrainFile) else "path"


Entry = Annotated[
    Annotated[str, Tag("path")] | Annotated[TerrainFile, Tag("file")], Discriminator(_kind)
]
"""A path alone, or with the values that the file does not state itself."""


def pinned(files: Sequence[Entry]) -> tuple[TerrainFile, ...]:
    """Return the same files with their absolute paths and digests.

    Raises:
        InputError: a file is missing.
    """
    found = []
    for each in map(_settled, files):
        try:
            digest = digest_of(each.file)
        except InputError as error:
            raise InputError(f"{KEY}: {error}") from error
        absolute = str(Path(each.file).absolute())
        found.append(each.model_copy(update={"file": absolute, "sha256": digest}))
    return tuple(found)


def read_own_terrain(files: Sequence[Entry], resolution: float) -> list[tuple[str, HeightMap]]:
    """Return the name of each file for messages, and its height map.

    Args:
        files: files that a configuration names.
        resolution: edge of a cell [m].

    Raises:
        InputError: one sentence with the key: a file is missing, has changed since its digest was
            recorded, cannot be read, or has cells of another size.
    """
    maps = []
    for each in map(_settled, files):
        try:
            require_digest(each.file, each.sha256)
            height_map = import_terrain(each.file, each.reading(resolution))
        except InputError as error:
            raise InputError(f"{KEY}: {error}") from error
        maps.append((f"{KEY}: {each.file}", height_map))
    return maps


def _settled(entry: Entry) -> TerrainFile:
    return TerrainFile(file=entry) if isinstance(entry, str) else entry
