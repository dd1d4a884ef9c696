"""Two legs that are mirror images, for planners that move their joints."""

from dataclasses import dataclass
from functools import cache

import numpy as np
from jaxtyping import Bool, Float

from jaxleas.geometry.polytopes import Polytope
from jaxleas.robots.chain import ChainPosture
from jaxleas.robots.limb_model import Body, LimbModel
from jaxleas.robots.robot import Robot
from jaxleas.robots.talos import load_talos
from jaxleas.types.errors import InputError

_ALIKE = 1e-6
"""Tolerance of the numbers of two legs that are mirror images [m, rad and kg]."""


@dataclass(frozen=True, eq=False)
class LegModel:
    """The left leg and the body; the right leg is the mirror image of the left one.

    For the right leg mirror inputs and outputs in the root's plane y = 0: positions by (1, -1, 1),
    rotations by that on both sides, angles by `mirror_signs`.

    Attributes:
        left: model of the left leg.
        body: all of the robot except its legs; limbs that do not stand, such as arms with palms,
            are in their reference posture.
    """

    left: LimbModel
    body: Body

    @property
    def joints(self) -> int:
        """Number of joints of one leg."""
        return len(self.left.chain)

    @property
    def lower(self) -> Float[np.ndarray, " J"]:
        """Lower joint limits of the left leg [rad]."""
        return self.left.chain.lower

    @property
    def upper(self) -> Float[np.ndarray, " J"]:
        """Upper joint limits of the left leg [rad]."""
        return self.left.chain.upper

    @property
    def reference(self) -> Float[np.ndarray, " J"]:
        """Joint angles of the left leg in the reference configuration [rad]."""
        return self.left.reference

    @property
    def mirror_signs(self) -> Float[np.ndarray, " J"]:
        """Signs that turn the left leg's angles into the right leg's in the mirrored posture."""
        return self.left.chain.mirror_signs

    @property
    def com_in_foot(self) -> Polytope:
        """Reach of the centre of mass from the left foot, in its frame rotated only by its yaw."""
        return self.left.com_reach

    @property
    def mass(self) -> float:
        """Mass of the whole robot [kg]."""
        return self.body.mass + 2.0 * float(self.left.link_mass.sum())


@cache
def legs_of(robot: Robot) -> LegModel:
    """Return the two legs of a robot.

    Raises:
        InputError: the robot's file describes no legs, or they are not two mirror images.
    """
    models = [robot.limbs[index].model for index in robot.feet]
    if robot.body is None or any(model is None for model in models):
        raise InputError(
            f"the file of robot '{robot.name}' has no 'body', or a leg of it no 'model': a planner"
            " that moves joints needs both; scripts/make_robot.py makes them from a URDF"
        )
    left, right = (models[0], models[1]) if len(models) == 2 else (None, None)
    if left is None or right is None:
        raise InputError(
            f"robot '{robot.name}' has {len(models)} legs; this planner moves two that are mirror"
            " images"
        )
    one, other = (robot.effectors[index] for index in robot.feet)
    different = unlike(left.mirrored(), right)
    different += [
        what
        for what, same in (
            ("half sizes of the soles", one.half_size == other.half_size),
            ("friction", one.friction == other.friction),
        )
        if not same
    ]
    if different:
        raise InputError(
            f"robot '{robot.name}' has 2 legs that are not two mirror images in the root's plane"
            f" y = 0, left before right, as this planner needs them: they differ in"
            f" {', '.join(different)}"
        )
    return LegModel(left, _with_resting_limbs(robot, robot.body))


def _with_resting_limbs(robot: Robot, body: Body) -> Body:
    """Return the body together with the limbs that do not stand, in their reference posture."""
    moment, mass = body.mass * body.com, body.mass
    resting = [
        limb.model
        for index, limb in enumerate(robot.limbs)
        if index not in robot.feet and limb.model is not None
    ]
    for model in resting:
        posture = model.posture(model.reference)
        moment = moment + model.mass_moment(posture.frames, posture.origins)
        mass += float(model.link_mass.sum())
    return Body(mass, moment / mass) if resting else body


def load_talos_legs() -> LegModel:
    """Return the legs of Talos."""
    return legs_of(load_talos())


def leg_posture(legs: LegModel, angles: Float[np.ndarray, "*batch J"]) -> ChainPosture:
    """Place the left leg's links in the root frame.

    Args:
        legs: pair of legs.
        angles: joint angles [rad].
    """
    return legs.left.posture(angles)


def leg_angles(
    legs: LegModel,
    sole: Float[np.ndarray, "*batch 3"],
    rotation: Float[np.ndarray, "*batch 3 3"],
    start: Float[np.ndarray, "*batch J"] | None = None,
) -> tuple[Float[np.ndarray, "*batch J"], Bool[np.ndarray, "*batch"]]:
    """Return the angles that bring the left sole to a pose, and whether it is in reach.

    Args:
        legs: pair of legs.
        sole: position of the sole in the root frame [m].
        rotation: orientation of the sole in the root frame.
        start: posture near each pose, if known [rad].
    """
    return legs.left.inverse(sole, rotation, start)


def mass_moment(
    legs: LegModel,
    frames: Float[np.ndarray, "*batch J 3 3"],
    origins: Float[np.ndarray, "*batch J 3"],
) -> Float[np.ndarray, "*batch 3"]:
    """Return the sum of mass times centre over a leg's links, in the inputs' frame [kg m]."""
    return legs.left.mass_moment(frames, origins)


def unlike(one: LimbModel, other: LimbModel) -> list[str]:
    """Return what two limbs differ in, as words; nothing for limbs that are the same."""
    if len(one.chain) != len(other.chain):
        return ["number of joints"]
    pairs = {
        "joint positions": (one.chain.positions, other.chain.positions),
        "joint rotations": (one.chain.rotations, other.chain.rotations),
        "joint axes": (one.chain.axes, other.chain.axes),
        "lower joint limits": (one.chain.lower, other.chain.lower),
        "upper joint limits": (one.chain.upper, other.chain.upper),
        "position of the sole": (one.chain.tip.position, other.chain.tip.position),
        "rotation of the sole": (one.chain.tip.rotation, other.chain.tip.rotation),
        "reference angles": (one.reference, other.reference),
        "masses": (one.link_mass, other.link_mass),
        "centres of mass": (one.link_com, other.link_com),
        "boxes": (_box_numbers(one), _box_numbers(other)),
        "capsules": (_capsule_numbers(one), _capsule_numbers(other)),
        "normals of the reach of the centre of mass": (
            one.com_reach.normals,
            other.com_reach.normals,
        ),
        "reach of the centre of mass": (one.com_reach.offsets, other.com_reach.offsets),
    }
    return [
        what
        for what, (a, b) in pairs.items()
        if a.shape != b.shape or np.abs(a - b).max(initial=0.0) > _ALIKE
    ]


def _box_numbers(limb: LimbModel) -> np.ndarray:
    rows = [(each.link, *each.box.low, *each.box.high) for each in limb.boxes]
    return np.array(rows, dtype=np.float64)


def _capsule_numbers(limb: LimbModel) -> np.ndarray:
    rows = [(each.link, *each.start, *each.end, each.radius) for each in limb.capsules]
    return np.array(rows, dtype=np.float64)
