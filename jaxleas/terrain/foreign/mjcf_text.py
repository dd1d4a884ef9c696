"""The part of an MJCF file that stands still, with the files that it needs.

Robots, cameras, textures and the like are taken out, so that a scene can be read without the files
of the robot that belongs to it. No file outside the folder of the model is opened.
"""

import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass
from pathlib import Path
from xml.etree.ElementTree import Element

from jaxleas.terrain.foreign.answers import RefusedError

MAX_TEXT = 2**26
MOST_INCLUDES = 100
_SECTIONS = ("compiler", "option", "default", "asset", "worldbody")
_ASSETS = ("mesh", "hfield")
_DEFAULTS = ("geom", "mesh", "default")
_PARTS = ("geom", "body", "frame", "replicate")
_MOVES = ("joint", "freejoint")
_FOLDERS = ("meshdir", "assetdir", "texturedir", "strippath")
_PICTURES = ("material", "mass", "density", "solref", "solimp")


@dataclass(frozen=True)
class StandingPart:
    """What MuJoCo compiles.

    Attributes:
        text: XML of the model.
        assets: contents of the files that it names.
        notes: what was left out.
    """

    text: str
    assets: dict[str, bytes]
    notes: list[str]


def standing_part(path: Path) -> StandingPart:
    """Return the standing part of an MJCF file.

    Raises:
        RefusedError: the file is no MJCF, or names a file that is missing.
    """
    root = _parsed(path)
    if root.tag != "mujoco":
        raise RefusedError(f"is XML with the root <{root.tag[:20]}>, not MJCF")
    missing: list[str] = []
    _include(root, path.parent, missing, [MOST_INCLUDES])
    compiler = [each for each in root if each.tag == "compiler"]
    folders = {
        name: each.attrib.pop(name) for each in compiler for name in _FOLDERS if name in each.attrib
    }
    for section in [*root]:
        if section.tag not in _SECTIONS:
            root.remove(section)
        elif section.tag == "asset":
            _keep(section, _ASSETS)
        elif section.tag == "default":
            for each in section.iter("default"):
                _keep(each, _DEFAULTS)
    for element in root.iter():
        if element.tag in ("geom", "mesh"):
            for name in _PICTURES:
                element.attrib.pop(name, None)
    moving = sum(_keep_still(each) for each in root if each.tag == "worldbody")
    notes = [f"includes {each}, which is missing: left out" for each in missing]
    if moving:
        notes.append(f"has {moving} bodies that move: left out")
    assets = _assets(root, path.parent, folders.get("meshdir", folders.get("assetdir", "")))
    return StandingPart(ElementTree.tostring(root, encoding="unicode"), assets, notes)


def _parsed(path: Path) -> Element:
    content = path.read_bytes()
    if len(content) > MAX_TEXT:
        raise RefusedError(f"is {len(content)} bytes of XML, more than {MAX_TEXT}")
    try:
        return ElementTree.fromstring(content)
    except (ElementTree.ParseError, ValueError, LookupError) as error:
        raise RefusedError(f"is not XML: {error}") from error


def _include(root: Element, folder: Path, missing: list[str], left: list[int]) -> None:
    """Put the content of included files in the place of each <include>."""
    for parent in [*root.iter()]:
        for at, child in reversed([*enumerate(parent)]):
            if child.tag != "include":
                continue
            left[0] -= 1
            if left[0] < 0:
                raise RefusedError(f"includes more than {MOST_INCLUDES} files")
            name = child.get("file", "")
            found = _inside(folder, name)
            parent.remove(child)
            if found is None:
                missing.append(name)
                continue
            inner = _parsed(found)
            _include(inner, folder, missing, left)
            for offset, each in enumerate([*inner]):
                parent.insert(at + offset, each)


def _keep(section: Element, tags: tuple[str, ...]) -> None:
    for each in [*section]:
        if each.tag not in tags:
            section.remove(each)


def _keep_still(body: Element) -> int:
    """Take out what moves, and what is no body or geom; return the number of moving bodies."""
    moving = 0
    for each in [*body]:
        moves = each.get("mocap") == "true" or any(inner.tag in _MOVES for inner in each)
        if each.tag not in _PARTS or (each.tag == "body" and moves):
            moving += each.tag == "body"
            body.remove(each)
        else:
            moving += _keep_still(each)
    return moving


def _assets(root: Element, folder: Path, meshes: str) -> dict[str, bytes]:
    """Return the files of used meshes and height fields; the model names them anew."""
    used = {(kind, each.get(kind, "")) for each in root.iter("geom") for kind in _ASSETS}
    contents: dict[str, bytes] = {}
    for section in root.iter("asset"):
        for each in [*section]:
            file = each.get("file", "")
            name = each.get("name") or Path(file).stem
            if (each.tag, name) not in used:
                section.remove(each)
                continue
            if not file:
                continue  # its numbers are in the model
            found = next(
                (
                    place
                    for place in (str(Path(meshes) / file), file, f"assets/{file}", Path(file).name)
                    if _inside(folder, place) is not None
                ),
                None,
            )
            if found is None:
                raise RefusedError(f"needs the file {file}, which is not in its folder")
            at = _inside(folder, found)
            assert at is not None
            each.set("name", name)
            each.set("file", f"asset_{len(contents)}{Path(file).suffix}")
            contents[each.get("file", "")] = at.read_bytes()
    return contents


def _inside(folder: Path, name: str) -> Path | None:
    """Return a file of this name below a folder, if there is one."""
    if not name or "\0" in name:
        return None
    found, root = (folder / name).resolve(), folder.resolve()
    return found if found.is_relative_to(root) and found.is_file() else None
