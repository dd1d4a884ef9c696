"""Postures: places of all feet at a configuration of the guide, and how they came about."""

from dataclasses import dataclass
from typing import Any, Literal, get_args

import numpy as np
from jaxtyping import Float

from jaxleas.contacts.problem import FootPose
from jaxleas.types import InputError

How = Literal["start", "kept", "stepped", "repositioned"]
"""The first; contacts kept while the root moved on; one made anew as the root moved on, or not."""


_OF_ALL = ("configuration", "how", "moved", "com")
"""Keys of a posture in a file that are not names of feet."""


@dataclass(frozen=True, eq=False)
class Posture:
    """All feet in contact at one configuration of a guide path.

    Attributes:
        configuration: index of the guide's configuration, counted from 0.
        how: way in which the posture came about.
        moved: name of the foot that was moved, such as "LF"; None at the start and where contacts
            are kept.
        feet: place of each foot: a point on its surface [m], and the foot's yaw [rad].
        surfaces: name of each foot's surface.
        com: centre of mass in the world [m].
    """

    configuration: int
    how: How
    moved: str | None
    feet: dict[str, FootPose]
    surfaces: dict[str, str]
    com: Float[np.ndarray, " 3"]


def posture_to_json(posture: Posture) -> dict[str, Any]:
    """Return a posture as a JSON value."""
    feet = {
        foot: {
            "position": posture.feet[foot].position.tolist(),
            "yaw": posture.feet[foot].yaw,
            "surface": posture.surfaces[foot],
        }
        for foot in posture.feet
    }
    return {
        "configuration": posture.configuration,
        "how": posture.how,
        "moved": posture.moved,
        **feet,
        "com": posture.com.tolist(),
    }


def posture_from_json(where: str, content: Any) -> Posture:
    """Return the posture in a JSON value.

    Raises:
        InputError: the value is not a posture; the message names `where`.
    """
    try:
        feet = {str(foot): each for foot, each in content.items() if foot not in _OF_ALL}
        read = Posture(
            configuration=int(content["configuration"]),
            how=content["how"],
            moved=content["moved"],
            feet={
                foot: FootPose(_vector(each["position"]), float(each["yaw"]))
                for foot, each in feet.items()
            },
            surfaces={foot: str(each["surface"]) for foot, each in feet.items()},
            com=_vector(content["com"]),
        )
        if not feet:
            raise ValueError("no foot stands")
    except (AttributeError, KeyError, TypeError, ValueError) as error:
        raise InputError(
            f"{where} is not a posture: it needs configuration, how, moved, com, and for each foot,"
            " such as LF and RF, position, yaw and surface, all numbers finite"
        ) from error
    if read.how not in get_args(How) or read.moved not in (None, *read.feet):
        raise InputError(
            f"{where}: how must be one of {', '.join(get_args(How))}, and moved one of"
            f" {', '.join(read.feet)} or null"
        )
    return read


def _vector(content: Any) -> np.ndarray:
    vector = np.array(content, dtype=np.float64)
    if vector.shape != (3,) or not np.isfinite(vector).all():
        raise ValueError(f"{content!r:.60} is not three finite numbers")
    return vector
