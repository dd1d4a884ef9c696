"""What a URDF does not state about a robot, and how closely its kinematics are sampled."""

from collections.abc import Mapping
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from jaxleas.configuration import NonNegative, Positive, Seed, Strict

Three = tuple[float, float, float]
Interval = tuple[float, float]
OF_HEIGHT = 1.0198
"""Height of Talos's root as it stands [m]: lengths that are not stated are its, to this scale."""
ONE_STEP = 0.32
"""Longest step of Talos [m]."""


class Corners(Strict):
    """A box around the body without its limbs, in the root frame."""

    low: Three
    """smallest x, y and z [m]"""
    high: Three
    """largest x, y and z [m]"""


class Reach(Strict):
    """How far from its place in the reference stance a foot may stand, horizontally."""

    back: Positive = 0.35
    """behind that place [m]"""
    ahead: Positive = 0.35
    """ahead of it [m]"""
    outward: Positive = 0.2152
    """away from the middle of the robot [m]"""


class Step(Strict):
    """What a step of one foot relative to another one may be."""

    longest: Positive = ONE_STEP
    """ahead or back, compared with the reference stance [m]"""
    apart: Positive = 0.17
    """least distance of the middles of two feet side by side [m]"""


class MakeOptions(Strict):
    """Choices for one robot; what is not stated is found from the URDF, or is to Talos's scale."""

    feet: Annotated[tuple[str, ...], Field(min_length=1)]
    """links of the feet, or frames at their soles"""
    hands: tuple[str, ...] = ()
    """links of the palms"""
    name: Annotated[str, Field(pattern=r"^[\w-]{1,60}$")] | None = None
    """name of the robot; by default that of the file"""
    root: str | None = None
    """link of the root; by default that of the URDF"""
    kind: Literal["foot", "point_foot"] | None = None
    """kind of the feet; by default as their shapes are"""
    sole: Three | None = None
    """middle of a sole in the frame of the first foot's link [m]; y is reversed for right feet"""
    half_size: tuple[Positive, Positive] | None = None
    """half length and half width of a sole [m]"""
    palm_half_size: tuple[Positive, Positive] = (0.04, 0.04)
    """half length and half width of a palm [m]"""
    friction: Positive = 0.5
    """friction coefficient between feet and ground"""
    reference: Mapping[str, float] = {}
    """angles of joints in the reference stance [rad]; a leg without any is brought to stand"""
    root_height: Positive | None = None
    """height of the root in the reference stance [m]"""
    reference_sole: tuple[float, float] | None = None
    """x and y of the first sole in the root frame, where the stance is looked for [m]"""
    walking_height: Positive | None = None
    """height of the root along guide paths [m]"""
    start_heights: Interval | None = None
    """lowest and highest start of an episode, above the walking height [m]"""
    contact_window: tuple[Positive, Positive] | None = None
    """how far ahead and to a side contacts of the next stretch may lie [m]"""
    trunk: tuple[Corners, ...] | None = None
    """boxes around the body without its limbs"""
    reach: Reach | None = None
    """how far a foot may stand from its place in the reference stance"""
    step: Step | None = None
    """what a step may be"""
    limits: Mapping[str, Interval] = {}
    """limits of joints that are narrower than the URDF's [rad]; a mirror image follows"""
    straight_knee: float | None = None
    """angle of the first leg's knee as the leg is straight [rad]; by default from its joints"""
    least_bend: NonNegative = 0.4
    """least bend of the knee of a foot in its range of motion [rad]"""
    least_bend_of_com: NonNegative = 0.2
    """likewise where the centre of mass is looked for [rad]"""
    most_tilt: Annotated[float, Field(gt=0.0, le=90.0)] = 15.0
    """largest slope of a sole, as seen from an upright root [degrees]"""
    clearance: NonNegative = 0.02
    """between a sole and the lowest part of the trunk [m]"""
    within: Positive = 0.005
    """how far a polytope may reach beyond the hull of the samples [m]"""
    samples: Annotated[int, Field(ge=20_000, le=100_000_000)] = 1_000_000
    """number of configurations of each leg that are drawn"""
    pairs: Annotated[int, Field(ge=1000, le=10_000_000)] = 40_000
    """number of stances over which the centre of mass is looked for"""
    seed: Seed = 0
    """seed of what is drawn"""
    cell: Positive = 0.04
    """cell of the terrain that the robot is for [m]"""
    packages: tuple[str, ...] = ()
    """folders of packages whose meshes the URDF names"""

    @model_validator(mode="after")
    def _once(self) -> Self:
        named = [*self.feet, *self.hands]
        twice = sorted({each for each in named if named.count(each) > 1})
        if twice:
            raise ValueError(f"feet and hands name '{twice[0]}' twice")
        return self

    def reach_for(self, height: float) -> Reach:
        """Return the reach of a robot whose root stands at a height [m]."""
        ratio = height / OF_HEIGHT
        base = Reach()
        return self.reach or Reach(
            **{key: round(getattr(base, key) * ratio, 3) for key in type(base).model_fields}
        )

    def step_for(self, feet: int, height: float, half_width: float, apart: float) -> Step:
        """Return the step of a robot.

        Args:
            feet: number of its feet: of many, two may lie apart by both their reaches.
            height: height of its root as it stands [m].
            half_width: half width of its soles [m].
            apart: distance of the nearest two feet in the reference stance, sideways [m].
        """
        ratio = height / OF_HEIGHT
        longest = ONE_STEP if feet <= 2 else 2.0 * ONE_STEP
        least = max(min(2.0 * half_width + 0.05 * ratio, 0.98 * apart), 1e-3)
        return self.step or Step(longest=round(longest * ratio, 3), apart=round(least, 3))
