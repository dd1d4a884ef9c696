"""Why a robot cannot stand at a place, and where it can instead."""

import math

import numpy as np
from jaxtyping import Float

from jaxleas.guide.nearest_place import nearest_place
from jaxleas.guide.places import HEADINGS, Places
from jaxleas.types import InputError, RootPose, is_ground


def require_valid(
    places: Places, name: str, place: tuple[float, float], yaw: float | None
) -> RootPose:
    """Return the pose of a robot that stands at a place, if it is valid.

    Args:
        places: places of the terrain.
        name: name of the pose in messages, such as "--from".
        place: place x, y [m].
        yaw: heading [rad]; None accepts any valid heading.

    Raises:
        InputError: the robot cannot stand there; the message says which condition fails, by
            how much, and which valid pose is nearest.
    """
    here = np.array([place])
    headings = HEADINGS if yaw is None else np.array([yaw])
    valid = places.valid(np.repeat(here, len(headings), axis=0), headings)
    if valid.any():
        chosen = float(headings[np.argmax(valid)])
        return places.pose(here[0], chosen)
    raise InputError(f"{name} {place[0]:g},{place[1]:g}: {_advice(places, here, headings, yaw)}")


def why_invalid(
    places: Places, place: Float[np.ndarray, " 2"], headings: Float[np.ndarray, " H"], facing: str
) -> str:
    """Return why a robot can stand at a place with none of the headings, and by how much.

    Args:
        places: places of the terrain.
        place: place x, y [m].
        headings: headings that were tried [rad].
        facing: those headings in words, such as "at yaw 1.5".
    """
    x_min, x_max, y_min, y_max = places.terrain.extent
    x, y = place
    if not (x_min <= x <= x_max and y_min <= y <= y_max):
        return f"off the map, which spans x {x_min:g} to {x_max:g}, y {y_min:g} to {y_max:g} m"
    if not is_ground(places.root_height(place[None])[0]):
        return "there is no ground"
    margins = places.margins(np.tile(place, (len(headings), 1)), headings)
    total = margins.pop("the condition")
    best = int(np.argmax(total))
    named = {name: float(each[best]) for name, each in margins.items()}
    failed = [f"{name} fails by {-m:.2f} m" for name, m in named.items() if m < 0.0]
    own = f"the condition fails by {-float(total[best]):.2f} m"
    return f"{facing} {' and '.join(failed) or own}"


def _advice(places: Places, here: np.ndarray, headings: np.ndarray, yaw: float | None) -> str:
    facing = "at any heading" if yaw is None else f"at yaw {yaw:g}"
    reason = why_invalid(places, here[0], headings, facing)
    nearest = nearest_place(places, here[0], yaw)
    if nearest is None:
        return f"{reason}; nowhere on this terrain can the robot stand"
    at, heading = nearest
    turned = f",{heading:.2f}" if yaw is not None else ""
    pose, away = f"{at[0]:.2f},{at[1]:.2f}{turned}", math.dist(at, here[0])
    return f"{reason}; the nearest valid pose is {pose}, {away:.2f} m away"
