"""Reading and writing a robot as one small JSON file."""

from pathlib import Path
from typing import Any

import numpy as np

from jaxleas.files import read_json, write_json
from jaxleas.geometry.boxes import Box
from jaxleas.geometry.polytopes import Polytope
from jaxleas.robots.robot import Limb, Robot
from jaxleas.types.errors import InputError


def read_robot(path: str | Path) -> Robot:
    """Return the robot described by a JSON file.

    Raises:
        InputError: the file is missing, is not JSON, or a key is missing or malformed.
    """
    described = read_json(path)
    try:
        half_length, half_width = described["foot_half_size"]
        return Robot(
            name=str(described["name"]),
            limbs=tuple(_limb(limb) for limb in described["limbs"]),
            trunk=tuple(Box(tuple(box["low"]), tuple(box["high"])) for box in described["trunk"]),
            root_height=float(described["root_height"]),
            walking_height=float(described["walking_height"]),
            mass=float(described["mass"]),
            friction=float(described["friction"]),
            foot_half_size=(float(half_length), float(half_width)),
        )
    except KeyError as error:
        raise InputError(f"{path} lacks the key {error}, which a robot needs") from error
    except (TypeError, ValueError) as error:
        raise InputError(f"{path} does not describe a robot: {error}") from error


def write_robot(path: str | Path, robot: Robot, **notes: Any) -> None:
    """Write `robot` as JSON, with `notes` (provenance) that `read_robot` passes over."""
    described = {
        "name": robot.name,
        **notes,
        "mass": robot.mass,
        "friction": robot.friction,
        "root_height": robot.root_height,
        "walking_height": robot.walking_height,
        "foot_half_size": list(robot.foot_half_size),
        "trunk": [{"low": list(box.low), "high": list(box.high)} for box in robot.trunk],
        "limbs": [
            {
                "name": limb.name,
                "normals": limb.range_of_motion.normals.tolist(),
                "offsets": limb.range_of_motion.offsets.tolist(),
            }
            for limb in robot.limbs
        ],
    }
    write_json(path, described)


def _limb(described: dict[str, Any]) -> Limb:
    normals = np.asarray(described["normals"], dtype=np.float64)
    offsets = np.asarray(described["offsets"], dtype=np.float64)
    return Limb(str(described["name"]), Polytope(normals, offsets))
