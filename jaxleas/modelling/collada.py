"""The corners of a COLLADA mesh (.dae): where its scene puts the positions of its geometries."""

from pathlib import Path
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

import numpy as np
from jaxtyping import Float

from jaxleas.files import read_bytes
from jaxleas.types import InputError

_MOST_BYTES = 2**28
_MOST_NODES = 10_000
_UPRIGHT = {
    "X_UP": np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]),
    "Y_UP": np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]]),
    "Z_UP": np.eye(3),
}
"""Rotations to z up, by the axis that a file says points up. URDFs' readers differ here: those of
ROS, whose files these are, turn a mesh upright, and so is it done here."""


def read_collada(path: Path) -> Float[np.ndarray, "N 3"]:
    """Return the corners of a COLLADA file in metres, z up.

    Raises:
        InputError: the file is not COLLADA, or holds what is not read.
    """
    content = read_bytes(path, _MOST_BYTES)
    if b"<!DOCTYPE" in content or b"<!ENTITY" in content:
        raise InputError(f"{path} declares a document type, which no mesh needs")
    try:
        root = ElementTree.fromstring(content)
        for each in root.iter():
            each.tag = each.tag.rpartition("}")[2]
        return _read(root)
    except (ElementTree.ParseError, ValueError, KeyError) as error:
        raise InputError(f"{path} is not a readable COLLADA mesh: {error}") from error


def _read(root: Element) -> Float[np.ndarray, "N 3"]:
    geometries = {each.get("id", ""): _positions(each) for each in root.iter("geometry")}
    nodes = {each.get("id", ""): each for each in root.iter("node")}
    unit = root.find("asset/unit")
    scale = 1.0 if unit is None else float(unit.get("meter", "1"))
    up = root.findtext("asset/up_axis", "Y_UP").strip()
    placed: list[np.ndarray] = []
    waiting = [(each, np.eye(4)) for scene in root.iter("visual_scene") for each in scene]
    visited = 0
    while waiting:
        node, outer = waiting.pop()
        visited += 1
        if visited > _MOST_NODES:
            raise ValueError("its scene has too many nodes, or nodes within themselves")
        if node.tag != "node":
            continue
        here = outer @ _transform(node)
        for each in node.findall("instance_geometry"):
            points = geometries[each.get("url", "").lstrip("#")]
            placed.append(points @ here[:3, :3].T + here[:3, 3])
        waiting += [(each, here) for each in node.findall("node")]
        named = [each.get("url", "").lstrip("#") for each in node.findall("instance_node")]
        waiting += [(nodes[each], here) for each in named]
    found = placed or list(geometries.values())
    points = np.concatenate(found) if found else np.zeros((0, 3))
    return scale * points @ _UPRIGHT[up].T


def _positions(geometry: Element) -> Float[np.ndarray, "N 3"]:
    """Return the positions of a geometry, which its `vertices` name."""
    sources = {each.get("id", ""): each for each in geometry.iter("source")}
    found = [
        sources[each.get("source", "").lstrip("#")]
        for vertices in geometry.iter("vertices")
        for each in vertices.findall("input")
        if each.get("semantic") == "POSITION"
    ]
    arrays = [np.array((each.findtext("float_array") or "").split(), float) for each in found]
    values = np.concatenate(arrays) if arrays else np.zeros(0)
    return values.reshape(-1, 3)


def _transform(node: Element) -> Float[np.ndarray, "4 4"]:
    """Return how a node places what it holds."""
    total = np.eye(4)
    for each in node:
        if each.tag not in ("matrix", "translate", "scale", "rotate"):
            continue
        values, step = np.array((each.text or "").split(), float), np.eye(4)
        if each.tag == "matrix":
            step = values.reshape(4, 4)
        elif each.tag == "translate":
            step[:3, 3] = values
        elif each.tag == "scale":
            step[:3, :3] = np.diag(values)
        else:
            x, y, z, angle = values
            cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
            turn = np.deg2rad(angle)
            rodrigues = np.sin(turn) * cross + (1.0 - np.cos(turn)) * (cross @ cross)
            step[:3, :3] = np.eye(3) + rodrigues
        total = total @ step
    return total
