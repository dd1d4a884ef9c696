"""Small scenes and straight guide paths."""

import numpy as np

from jaxleas.terrain.polygons import box_faces
from jaxleas.terrain.scene import Scene
from jaxleas.types import GuidePath

DEPTH, RISER, LEAD, STEPS = 0.3, 0.1, 1.2, 8


def floor(x0: float, x1: float, y0: float, y1: float, z: float = 0.0) -> np.ndarray:
    return np.array([[x0, y0, z], [x1, y0, z], [x1, y1, z], [x0, y1, z]], dtype=np.float64)


def flat() -> Scene:
    return Scene({"floor": floor(-2.0, 8.0, -2.0, 2.0)})


def hole() -> Scene:
    return Scene({"here": floor(-2.0, 1.5, -2.0, 2.0), "there": floor(3.0, 8.0, -2.0, 2.0)})


def wall() -> Scene:
    faces = box_faces(floor(2.0, 2.2, -1.0, 1.0)[:, :2], 0.0, 1.5)
    return Scene(flat().surfaces, {f"wall_{name}": face for name, face in faces.items()})


def stairs() -> Scene:
    surfaces = {"bottom": floor(-1.0, LEAD, -0.9, 0.9)}
    for step in range(STEPS):
        x = LEAD + step * DEPTH
        surfaces[f"step_{step}"] = floor(x + 0.01, x + DEPTH - 0.01, -0.9, 0.9, (step + 1) * RISER)
    x = LEAD + STEPS * DEPTH
    surfaces["top"] = floor(x + 0.01, x + 3.0, -0.9, 0.9, (STEPS + 1) * RISER)
    return Scene(surfaces)


def straight(
    length: float,
    height: float = 0.9,
    y: float = 0.0,
    start: float = 0.5,
    climbing: bool = False,
    yaw: float = 0.0,
) -> GuidePath:
    """A guide path along x at 0.1 m/s, a configuration every 2 cm."""
    rows = round(length / 0.02) + 1
    x = start + 0.02 * np.arange(rows)
    ground = np.clip((x - LEAD + 0.5 * DEPTH) / DEPTH, 0.0, STEPS + 1.0) * RISER * climbing
    position = np.column_stack([x, np.full(rows, y), ground + height])
    velocity = np.tile([0.1, 0.0, 0.0], (rows, 1))
    time = 0.2 * np.arange(rows)
    return GuidePath(time, position, np.full(rows, yaw), velocity, np.ones(rows, dtype=bool))
