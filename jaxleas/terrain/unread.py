"""Kinds of files that people have terrains in and that are not read, with what would do."""

from pathlib import Path

from jaxleas.types import InputError

_MESH = "export it as .glb, .stl or .obj, as Blender does (File > Export)"
_IMAGE = "save it as .png, best with 16 bits of grey"
_WORLD = "give the mesh (.stl, .obj, .glb) of its terrain, or an MJCF model (.xml)"
_CLOUD = "make a grid of heights of it, as CloudCompare or PDAL do: GeoTIFF (.tif) or .asc"
_KINDS = (
    ("a USD stage", _MESH, (".usd", ".usda", ".usdc", ".usdz")),
    ("a mesh of a kind", _MESH, (".gltf", ".dae", ".fbx", ".3ds", ".3mf", ".blend", ".step")),
    ("an image of a kind", _IMAGE, (".jpg", ".jpeg", ".bmp", ".gif", ".webp", ".exr")),
    ("a world or robot", _WORLD, (".sdf", ".world", ".urdf", ".xacro")),
    (
        "a packed file",
        "unpack it first",
        (".zip", ".gz", ".bz2", ".xz", ".7z", ".rar", ".tar", ".tgz"),
    ),
    ("a cloud of points", _CLOUD, (".las", ".laz", ".pcd", ".e57", ".xyz")),
)


def refuse_unread(path: str | Path) -> None:
    """Refuse a file of a known kind that is not read.

    Raises:
        InputError: the message says how to convert it.
    """
    suffix = Path(path).suffix.lower()
    for title, remedy, suffixes in _KINDS:
        if suffix in suffixes:
            raise InputError(f"{path} is {title} that is not read: {remedy}")
