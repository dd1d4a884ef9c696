"""What a humanoid's legs look like to a planner that moves their joints."""

from dataclasses import dataclass
from functools import cache
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float

from jaxleas.files import read_json
from jaxleas.geometry.boxes import Box
from jaxleas.geometry.polytopes import Polytope
from jaxleas.types.errors import InputError

JOINTS = 6
"""Hip yaw, hip roll, hip pitch, knee, ankle pitch, ankle roll."""
MIRRORED_JOINTS = np.array([-1.0, -1.0, 1.0, 1.0, 1.0, -1.0])
"""The left leg's angles times this are the right leg's in the mirrored pose."""


@dataclass(frozen=True, eq=False)
class LegModel:
    """The left leg; the right one is its mirror image in the root's plane y = 0.

    Three hip axes meet in one point, two ankle axes in another, so the inverse has a closed form.

    Attributes:
        hip: where the hip's axes meet, in the root frame [m].
        thigh: from hip to knee [m].
        shank: from knee to ankle [m].
        sole: from ankle to the sole below it [m].
        lower: joint limits [rad].
        upper: joint limits [rad].
        reference: the joint angles one stands with [rad].
        link_mass: of the six links [kg].
        link_com: centre of mass of each link in its joint's frame [m].
        body_mass: of all that is not leg [kg].
        body_com: its centre of mass in the root frame, arms in the reference posture [m].
        thigh_box: around the thigh, in the frame of the hip pitch joint [m].
        shank_box: around the shank, in the frame of the knee [m].
        foot_box: around the foot, in the frame of the ankle roll joint [m].
        com_in_foot: where the whole robot's centre of mass can be while the left foot stands:
            in the frame of the sole turned by the foot's yaw alone [m].
    """

    hip: Float[np.ndarray, " 3"]
    thigh: float
    shank: float
    sole: float
    lower: Float[np.ndarray, " 6"]
    upper: Float[np.ndarray, " 6"]
    reference: Float[np.ndarray, " 6"]
    link_mass: Float[np.ndarray, " 6"]
    link_com: Float[np.ndarray, "6 3"]
    body_mass: float
    body_com: Float[np.ndarray, " 3"]
    thigh_box: Box
    shank_box: Box
    foot_box: Box
    com_in_foot: Polytope

    @property
    def mass(self) -> float:
        """Of the whole robot [kg]."""
        return self.body_mass + 2.0 * float(self.link_mass.sum())


@cache
def load_talos_legs() -> LegModel:
    """Return Talos's legs from the file that scripts/make_talos_legs.py made from the URDF."""
    shipped = resources.files("jaxleas.robots") / "data" / "talos_legs.json"
    with resources.as_file(shipped) as path:
        return read_legs(path)


def read_legs(path: str | Path) -> LegModel:
    """Return the legs described by a JSON file.

    Raises:
        InputError: the file is missing, is not JSON, or a key is missing or malformed.
    """
    described = read_json(path)
    try:
        return LegModel(
            hip=_array(described["hip"], (3,)),
            thigh=float(described["thigh"]),
            shank=float(described["shank"]),
            sole=float(described["sole"]),
            lower=_array(described["lower"], (JOINTS,)),
            upper=_array(described["upper"], (JOINTS,)),
            reference=_array(described["reference"], (JOINTS,)),
            link_mass=_array(described["link_mass"], (JOINTS,)),
            link_com=_array(described["link_com"], (JOINTS, 3)),
            body_mass=float(described["body_mass"]),
            body_com=_array(described["body_com"], (3,)),
            thigh_box=_box(described["thigh_box"]),
            shank_box=_box(described["shank_box"]),
            foot_box=_box(described["foot_box"]),
            com_in_foot=Polytope(
                np.asarray(described["com_in_foot"]["normals"], dtype=np.float64),
                np.asarray(described["com_in_foot"]["offsets"], dtype=np.float64),
            ),
        )
    except KeyError as error:
        raise InputError(f"{path} lacks the key {error}, which a leg model needs") from error
    except (TypeError, ValueError, IndexError) as error:
        raise InputError(f"{path} does not describe legs: {error}") from error


def _array(value: Any, shape: tuple[int, ...]) -> np.ndarray:
    array = np.asarray(value, dtype=np.float64)
    if array.shape != shape or not np.isfinite(array).all():
        raise ValueError(f"expected finite numbers of shape {shape}, got shape {array.shape}")
    return array


def _box(value: Any) -> Box:
    low, high = _array(value["low"], (3,)), _array(value["high"], (3,))
    return Box(tuple(low.tolist()), tuple(high.tolist()))
