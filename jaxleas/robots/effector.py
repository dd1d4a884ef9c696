"""Effectors, where a limb touches: a foot, a palm or a point foot."""

from dataclasses import dataclass, field
from typing import Literal, get_args

import numpy as np
from jaxtyping import Float

from jaxleas.types import InputError, Pose

Kind = Literal["foot", "palm", "point_foot"]
"""A foot stands with a sole, a palm presses against surfaces of any slope, a point foot stands
without a sole."""
FOOT_OF_LIMB = {"left": "LF", "right": "RF"}
"""Default names of a biped's feet; by default a foot of another limb has the limb's name."""


LIMB_OF_FOOT = {foot: limb for limb, foot in FOOT_OF_LIMB.items()}


@dataclass(frozen=True, eq=False)
class Effector:
    """The part of a limb that touches.

    Attributes:
        name: name in contact problems and plans, such as "LF".
        kind: kind of effector.
        half_size: half length and half width of the touching surface [m]; zeros for a point foot.
        friction: friction coefficient mu between effector and surface [1].
        force_limit: largest force along the contact normal [N]; None for no limit.
        link: name of the URDF's link that it belongs to; empty if no URDF is known.
        frame: pose of the effector in the frame of that link: its origin is the middle of the
            touching surface, its first axis runs along the length, its third one away from the
            contact surface.

    Raises:
        InputError: the kind is unknown, or a number is out of range.
    """

    name: str
    kind: Kind
    half_size: tuple[float, float]
    friction: float
    force_limit: float | None = None
    link: str = ""
    frame: Pose = field(default_factory=Pose.identity)

    def __post_init__(self) -> None:
        if not self.name:
            raise InputError("an effector needs a name, such as LF")
        if self.kind not in get_args(Kind):
            raise InputError(
                f"effector '{self.name}' is of no known kind: {self.kind!r:.60}; there are"
                f" {', '.join(get_args(Kind))}"
            )
        sizes = np.asarray(self.half_size, dtype=np.float64)
        if sizes.shape != (2,) or not (np.isfinite(sizes).all() and (sizes >= 0.0).all()):
            raise InputError(
                f"effector '{self.name}': half_size must be half length and half width [m], not"
                f" {self.half_size!r:.60}"
            )
        if (self.kind == "point_foot") != bool((sizes == 0.0).all()):
            raise InputError(
                f"effector '{self.name}' of kind {self.kind} has half sizes {self.half_size}: those"
                " of a point foot are 0, those of others are not"
            )
        if not (np.isfinite(self.friction) and self.friction > 0.0):
            raise InputError(
                f"effector '{self.name}': friction must be a positive number, not {self.friction}"
            )
        if self.force_limit is not None and not self.force_limit > 0.0:
            raise InputError(
                f"effector '{self.name}': force_limit must be a positive number [N], or null for"
                f" none, not {self.force_limit}"
            )

    @property
    def stands(self) -> bool:
        """Whether the effector carries a walking robot: feet do, palms do not."""
        return self.kind != "palm"

    @property
    def corners(self) -> Float[np.ndarray, "C 3"]:
        """Corners of the touching surface, counter-clockwise in the effector's frame [m].

        A point foot has one corner.
        """
        x, y = self.half_size
        if self.kind == "point_foot":
            return np.zeros((1, 3))
        return np.array([[x, y, 0.0], [-x, y, 0.0], [-x, -y, 0.0], [x, -y, 0.0]])


def foot_of_limb(limb: str, half_size: tuple[float, float], friction: float) -> Effector:
    """Return the foot of a limb whose file describes no effector.

    Args:
        limb: name of the limb.
        half_size: half length and half width of the sole [m].
        friction: friction coefficient mu between sole and ground [1].
    """
    kind = "foot" if any(half_size) else "point_foot"
    return Effector(FOOT_OF_LIMB.get(limb, limb), kind, half_size, friction)
