"""The kinds of mesh files, one line each: whatever lists or reads them looks here."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from jaxleas.terrain.meshes.files import Triangles, read_faces, read_glb, read_placed, read_stl
from jaxleas.terrain.reading import MAPPING


@dataclass(frozen=True)
class MeshFormat:
    """A kind of file with faces.

    Attributes:
        title: what it is, for messages.
        read: reader of the triangles, in the file's units.
        options: names of the options that apply.
    """

    title: str
    read: Callable[[Path], Triangles]
    options: tuple[str, ...] = (*MAPPING, "up", "scale")


MESHES: dict[str, MeshFormat] = {
    ".stl": MeshFormat("a mesh", read_stl),
    ".obj": MeshFormat("a mesh", read_faces),
    ".ply": MeshFormat("a mesh", read_faces),
    ".off": MeshFormat("a mesh", read_faces),
    ".glb": MeshFormat("a mesh", read_glb),
    ".xml": MeshFormat("an MJCF model in metres with z up", read_placed, MAPPING),
    ".yaml": MeshFormat("a list of boxes in metres", read_placed, MAPPING),
    ".yml": MeshFormat("a list of boxes in metres", read_placed, MAPPING),
}
