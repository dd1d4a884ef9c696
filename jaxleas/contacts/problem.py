"""The contact problem: the effector that moves in each step, and its surfaces (T 5.1, B.1)."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np
from jaxtyping import Float

from jaxleas.contacts.polytopes import StepPolytopes
from jaxleas.contacts.surfaces import ContactSurface
from jaxleas.types import InputError

Model = Literal["two_com", "feet"]
TWO = 2
"""Number of effectors in the model two_com: the centre of mass is over one, then the other."""


@dataclass(frozen=True, eq=False)
class FootPose:
    """The pose of a standing effector, whose frame is turned about the vertical alone.

    Attributes:
        position: middle of the area that touches, in the world [m].
        yaw: heading [rad].
    """

    position: Float[np.ndarray, " 3"]
    yaw: float


@dataclass(frozen=True, eq=False)
class Step:
    """The landing of one effector while the others stand.

    Attributes:
        foot: name of the effector that moves, such as "LF".
        yaw: heading with which it lands [rad].
        candidates: names of the surfaces it may land on.
        root: position of the guide path's root, in the world [m]; None if there is no guide.
    """

    foot: str
    yaw: float
    candidates: tuple[str, ...]
    root: Float[np.ndarray, " 3"] | None = None


Phase = Step
"""The former name of `Step`."""


@dataclass(frozen=True, eq=False)
class ContactProblem:
    """Find a foothold for each step.

    Attributes:
        robot: name of the robot.
        model: "feet" (relative foot polytopes only) or "two_com" (T app. B: two positions of the
            centre of mass per step as well).
        surfaces: surfaces by name.
        initial: pose of each effector before the first step, in the robot's order.
        steps: steps in order; the candidates of the last one are the goal.
        polytopes: reach of a step and of the centre of mass.
        half_sizes: half length and half width of each effector's sole [m], by the effector's name;
            zeros for a point foot.
        parts: name of the whole surface of each surface that is part of one.

    Raises:
        InputError: an effector has no half sizes, or model "two_com" is given other than two
            effectors, or lacks its polytopes.
    """

    robot: str
    model: Model
    surfaces: dict[str, ContactSurface]
    initial: dict[str, FootPose]
    steps: tuple[Step, ...]
    polytopes: StepPolytopes
    half_sizes: Mapping[str, tuple[float, float]]
    parts: Mapping[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        without = [name for name in self.initial if name not in self.half_sizes]
        if without:
            raise InputError(
                f"a contact problem needs the half sizes of each effector: those of"
                f" {', '.join(without)} are missing"
            )
        if self.model != "two_com":
            return
        if len(self.initial) != TWO:
            raise InputError(
                f"model two_com is of two feet, and {len(self.initial)} stand here"
                f" ({', '.join(self.initial)}): ask for model feet"
            )
        missing = [f"COM_in_{name}" for name in self.initial if name not in self.polytopes.com]
        if missing:
            raise InputError(
                f"robot {self.robot!r} has no step polytopes {', '.join(missing)}, which model"
                " two_com needs: give them, or ask for model feet"
            )

    def __len__(self) -> int:
        """Return the number of steps."""
        return len(self.steps)

    @property
    def phases(self) -> "tuple[Step, ...]":
        """The former name of `steps`, still that of the file's key."""
        return self.steps

    @property
    def effectors(self) -> tuple[str, ...]:
        """Names of the effectors that step or stand."""
        return tuple(self.initial)

    @property
    def whole_surfaces(self) -> tuple[str, ...]:
        """Names of the surfaces that are not part of another."""
        return tuple(name for name in self.surfaces if name not in self.parts)

    def whole(self, name: str) -> str:
        """Return the name of the whole surface that a surface is, or is part of."""
        return self.parts.get(name, name)

    def prefix(self, count: int) -> "ContactProblem":
        """Return the problem of the first `count` steps."""
        return replace(self, steps=self.steps[:count])

    def with_candidates(self, candidates: "list[tuple[str, ...]]") -> "ContactProblem":
        """Return the problem with other candidates, one tuple per step."""
        steps = zip(self.steps, candidates, strict=True)
        return replace(self, steps=tuple(replace(step, candidates=names) for step, names in steps))

    def without_guide(self) -> "ContactProblem":
        """Return the contact-before-motion problem: any whole surface for any step but the last.

        Orientations stay those of the steps; the last step keeps its candidates, the goal.
        """
        every = self.whole_surfaces
        free = [every] * (len(self) - 1)
        return self.with_candidates([*free, self.steps[-1].candidates])
