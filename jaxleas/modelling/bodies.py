"""Masses and shapes of a URDF's links; boxes of inertia stand in for shapes that are missed."""

from dataclasses import dataclass
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np
from jaxtyping import Float

from jaxleas.modelling.mesh_search import MeshSearch
from jaxleas.robots import rotation_of_rpy, three_numbers
from jaxleas.types import InputError

_ZERO = (0.0, 0.0, 0.0)
_AROUND = 64  # points on the rim of a cylinder
_LARGEST = 20.0
"""Size above which a mesh is in other units than metres [m]."""


@dataclass(frozen=True, eq=False)
class Shape:
    """All points within `radius` of the convex hull of `points`, in the frame of the link [m]."""

    points: Float[np.ndarray, "P 3"]
    radius: float = 0.0


@dataclass(frozen=True, eq=False)
class LinkBody:
    """What a link weighs, and what it looks like.

    Attributes:
        name: name of the link.
        mass: mass [kg].
        com: centre of mass in the frame of the link [m].
        shapes: collision shapes, else those that are seen, else a box of the link's inertia.
        guessed: whether `shapes` is such a box.
        outline: shapes that show how large the link is: where those of collision are balls alone,
            such as at the corners of a sole, those that are seen, too.
    """

    name: str
    mass: float
    com: Float[np.ndarray, " 3"]
    shapes: tuple[Shape, ...]
    guessed: bool = False
    outline: tuple[Shape, ...] = ()


def read_bodies(path: Path, element: Element, search: MeshSearch) -> dict[str, LinkBody]:
    """Return the bodies of all links of a <robot>, by name.

    Args:
        path: URDF file, for messages.
        element: the <robot>.
        search: where its meshes are; it is told which are missed.

    Raises:
        InputError: a link has no name of its own, or a number is none.
    """
    bodies: dict[str, LinkBody] = {}
    for link in element.findall("link"):
        name = link.get("name", "")
        if not name or name in bodies:
            raise InputError(f"{path} has two links called '{name}'; each needs a name of its own")
        try:
            bodies[name] = _body(name, link, search)
        except ValueError as error:
            raise InputError(f"{path}: link '{name}' is not one of a URDF: {error}") from error
    return bodies


def _body(name: str, link: Element, search: MeshSearch) -> LinkBody:
    inertial = link.find("inertial")
    mass, com, turn = 0.0, np.zeros(3), np.eye(3)
    if inertial is not None:
        com, turn = _origin(inertial)
        mass = _number(inertial.find("mass"), "value")
        if not (np.isfinite(mass) and mass >= 0.0):
            raise ValueError(f"its mass is {mass}")
    touching = _shapes(link, "collision", search)
    if touching and any(len(each.points) > 1 for each in touching):
        return LinkBody(name, mass, com, touching, outline=touching)
    seen = _shapes(link, "visual", search)
    if touching or seen:
        return LinkBody(name, mass, com, touching or seen, outline=(*touching, *seen))
    shaped = link.find("collision") is not None or link.find("visual") is not None
    box = _inertia_box(inertial, mass, com, turn) if shaped else None
    boxes = () if box is None else (box,)
    return LinkBody(name, mass, com, boxes, box is not None, boxes)


def _shapes(link: Element, kind: str, search: MeshSearch) -> tuple[Shape, ...]:
    found = [_shape(each, search) for each in link.findall(kind)]
    return tuple(each for each in found if each is not None)


def _shape(element: Element, search: MeshSearch) -> Shape | None:
    """Return a collision or visual element as a shape; None where its mesh is missed."""
    place, turn = _origin(element)
    geometry = element.find("geometry")
    inner = None if geometry is None or not len(geometry) else geometry[0]
    if inner is None:
        return None
    radius = 0.0
    if inner.tag == "mesh":
        points = search.points(inner.get("filename", ""))
        if points is None:
            return None
        points = points * three_numbers(inner, "scale", (1.0, 1.0, 1.0))
        if np.ptp(points, axis=0).max() > _LARGEST:
            search.missed[inner.get("filename", "")] = "it is larger than 20 m: in other units?"
            return None
    elif inner.tag == "box":
        points = 0.5 * three_numbers(inner, "size", _ZERO) * _signs()
    elif inner.tag == "sphere":
        points, radius = np.zeros((1, 3)), _number(inner, "radius")
    elif inner.tag in ("cylinder", "capsule"):
        width, half = _number(inner, "radius"), 0.5 * _number(inner, "length")
        if inner.tag == "capsule":
            points, radius = np.array([[0.0, 0.0, -half], [0.0, 0.0, half]]), width
        else:
            angles = np.linspace(0.0, 2.0 * np.pi, _AROUND, endpoint=False)
            rim = width * np.stack([np.cos(angles), np.sin(angles), 0.0 * angles], axis=1)
            end = np.array([0.0, 0.0, half])
            points = np.concatenate([rim - end, rim + end])
    else:
        return None
    return Shape(points @ turn.T + place, radius)


def _inertia_box(
    inertial: Element | None, mass: float, com: np.ndarray, turn: np.ndarray
) -> Shape | None:
    """Return the box of even density that has a link's mass and inertia; None without any."""
    tensor = None if inertial is None else inertial.find("inertia")
    if tensor is None or mass <= 0.0:
        return None
    xx, xy, xz, yy, yz, zz = (
        _number(tensor, key, 0.0) for key in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
    )
    moments, axes = np.linalg.eigh(np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]))
    # A box of sides a, b, c has moments m (b^2 + c^2) / 12 and so on.
    squares = 6.0 * (moments.sum() - 2.0 * moments) / mass
    half = 0.5 * np.sqrt(np.clip(squares, 1e-6, None))
    return Shape((_signs() * half) @ (turn @ axes).T + com)


def _signs() -> Float[np.ndarray, "8 3"]:
    return np.array([[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])


def _origin(element: Element) -> tuple[np.ndarray, np.ndarray]:
    origin = element.find("origin")
    turn = rotation_of_rpy(*three_numbers(origin, "rpy", _ZERO).tolist())
    return three_numbers(origin, "xyz", _ZERO), turn


def _number(element: Element | None, key: str, otherwise: float = float("nan")) -> float:
    text = None if element is None else element.get(key)
    value = otherwise if text is None else float(text)
    if not np.isfinite(value):
        raise ValueError(f"{key}='{text}' is not a finite number")
    return value
