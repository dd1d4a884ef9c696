"""Which legs are the same, and with which feet a robot can stand while it moves one."""

from collections.abc import Sequence

import numpy as np

from jaxleas.robots.effector import Effector
from jaxleas.robots.limb_model import LimbModel
from jaxleas.types import InputError

_ALIKE = 1e-6
"""Tolerance of the numbers of two limbs that are the same [m, rad and kg]."""
ALL_DIRECTIONS = 6
"""Least number of joints that bring a sole to any place and orientation nearby."""


def same_model(one: LimbModel, other: LimbModel) -> bool:
    """Return whether two limbs have the same joints, masses, shapes and reach."""
    pairs = zip(_numbers(one), _numbers(other), strict=True)
    return all(a.shape == b.shape and np.abs(a - b).max(initial=0.0) <= _ALIKE for a, b in pairs)


def require_that_feet_can_stand(
    robot: str, effectors: Sequence[Effector], models: Sequence[LimbModel]
) -> None:
    """Refuse a robot that could not stand on its other feet while it moves one.

    Args:
        robot: name of the robot, for messages.
        effectors: its feet.
        models: models of its legs.

    Raises:
        InputError: says what is missing.
    """
    if len(effectors) < 2:
        raise InputError(
            f"robot '{robot}' has {len(effectors)} feet; a planner that moves one foot at a time"
            " needs at least two, one of which stands"
        )
    for effector, model in zip(effectors, models, strict=True):
        if effector.kind == "foot" and len(model.chain) < ALL_DIRECTIONS:
            raise InputError(
                f"robot '{robot}': the leg of {effector.name} has {len(model.chain)} joints, which"
                f" cannot lay a sole flat on a surface: a sole needs {ALL_DIRECTIONS} joints; a"
                " foot of kind 'point_foot' needs none for that"
            )
    for effector in effectors:
        others = [each for each in effectors if each is not effector]
        if len(others) < 3 and all(each.kind == "point_foot" for each in others):
            raise InputError(
                f"robot '{robot}' would stand on {len(others)} points alone while {effector.name}"
                " moves, and they span no area for its centre of mass: this planner needs three"
                " other point feet, or another foot with a sole"
            )


def _numbers(limb: LimbModel) -> list[np.ndarray]:
    chain, reach = limb.chain, limb.com_reach
    boxes = [(each.link, *each.box.low, *each.box.high) for each in limb.boxes]
    capsules = [(each.link, *each.start, *each.end, each.radius) for each in limb.capsules]
    return [
        *(chain.positions, chain.rotations, chain.axes, chain.lower, chain.upper),
        *(chain.tip.position, chain.tip.rotation, limb.reference, limb.link_mass, limb.link_com),
        *(np.array(boxes, dtype=np.float64), np.array(capsules, dtype=np.float64)),
        *(reach.normals, reach.offsets),
    ]
