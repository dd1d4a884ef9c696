"""Boxes and capsules of a robot: around the trunk, and around the links of a leg."""

from collections.abc import Collection, Iterable, Mapping, Sequence

import numpy as np
from jaxtyping import Float

from jaxleas.geometry import Box
from jaxleas.modelling.bodies import Shape
from jaxleas.modelling.legs import Leg
from jaxleas.modelling.soles import outlines_around
from jaxleas.modelling.tree import MOVING, UrdfTree
from jaxleas.robots import Capsule, LinkBox
from jaxleas.types import InputError, Pose

_DIGITS = 4
_ABOVE_SOLE = 0.08
"""Height above the sole below which the box of a leaning shank would meet the ground [m]."""
_ABOVE_ANKLE = 0.03
"""Where the box of a shank ends if its ankle is lower than that [m]."""
_LEAST = 0.01  # smallest size of a box [m]
_ARM, _SHOULDER = 4, 2
"""Least number of joints of an arm, and number of its first links that belong to the trunk."""


def bounds_of(shapes: Iterable[Shape]) -> tuple[np.ndarray, np.ndarray] | None:
    """Return the lowest and highest corner around shapes [m]; None without any."""
    lows, highs = [], []
    for each in shapes:
        lows.append(each.points.min(axis=0) - each.radius)
        highs.append(each.points.max(axis=0) + each.radius)
    if not lows:
        return None
    return np.min(lows, axis=0), np.max(highs, axis=0)


def trunk_boxes(
    tree: UrdfTree, root: str, poses: Mapping[str, Pose], legs: Sequence[Leg]
) -> tuple[Box, ...]:
    """Return boxes around the body without its limbs, in the reference stance.

    One around what moves with the root, with a biped's thighs, and one around all that is above it,
    without arms.

    Raises:
        InputError: no link of the body has a shape or an inertia.
    """
    moving = {
        joint.child: leg
        for leg in legs
        for joint in tree.path_to(leg.link, root)
        if joint.name in leg.chain.names
    }
    hanging = {link for link in poses if _hangs_on(tree, tree.carrier(link), moving)}
    arms = far_of_arms(tree, {*poses} - hanging)
    lower: list[Shape] = []
    upper: list[Shape] = []
    for name, pose in poses.items():
        carrier = tree.carrier(name)
        shapes = [
            Shape(pose.transform(each.points), each.radius) for each in tree.bodies[name].outline
        ]
        if carrier in moving:
            leg = moving[carrier]
            index = leg.chain.names.index(tree.above[carrier].name)
            if len(legs) <= 2 and index < leg.knee:
                lower += shapes
        elif carrier == tree.carrier(root):
            lower += shapes
        elif carrier not in arms and name not in hanging:
            upper += shapes
    boxes = [_box(*found) for found in map(bounds_of, (lower, upper)) if found is not None]
    if not boxes:
        raise InputError(
            f"{tree.path}: no link of the body has a shape or an inertia: state the"
            " boxes of `trunk`"
        )
    return tuple(boxes)


def far_of_arms(tree: UrdfTree, links: Collection[str]) -> set[str]:
    """Return the links of arms beyond the shoulder: of side branches of four joints and more.

    Args:
        tree: links of the robot.
        links: names of all links that are not of legs.
    """
    below: dict[str, list[str]] = {}
    for joint in tree.joints:
        if joint.kind in MOVING and joint.child in links:
            below.setdefault(tree.carrier(joint.parent), []).append(joint.child)
    far: set[str] = set()

    def depth(link: str) -> int:
        return 1 + max(map(depth, below.get(link, ())), default=0)

    def visit(link: str, along: int) -> None:
        branches = below.get(link, ())
        for child in branches:
            arm = along or (len(branches) > 1 and depth(child) >= _ARM)
            if along >= _SHOULDER:
                far.add(child)
            visit(child, along + 1 if arm else 0)

    visit(tree.root, 0)
    return far


def _hangs_on(tree: UrdfTree, link: str, legs: Mapping[str, Leg]) -> bool:
    """Tell whether a link hangs on a leg."""
    while link in tree.above:
        if link in legs:
            return True
        link = tree.above[link].parent
    return False


def _box(low: Float[np.ndarray, " 3"], high: Float[np.ndarray, " 3"]) -> Box:
    """Return a box of some size in each direction, rounded."""
    spare = np.maximum(0.5 * (_LEAST - (high - low)), 0.0)
    low, high = np.round(low - spare, _DIGITS), np.round(high + spare, _DIGITS)
    return Box(tuple((low + 0.0).tolist()), tuple((high + 0.0).tolist()))


def leg_shapes(
    tree: UrdfTree, root: str, leg: Leg
) -> tuple[tuple[LinkBox, ...], tuple[Capsule, ...]]:
    """Return the boxes around a leg's links from the thigh on, and capsules of shank and foot."""
    links = [j.child for j in tree.path_to(leg.link, root) if j.name in leg.chain.names]
    last = len(leg.chain) - 1
    boxes: list[LinkBox] = []
    for index, link in enumerate(links):
        found = bounds_of(outlines_around(tree, link))
        if found is None or index not in (leg.knee - 1, leg.knee, last):
            continue
        low, high = found
        tip = leg.chain.tip
        if index == last and leg.flat:  # below its sole there is the ground
            _cut(low, high, -tip.rotation[:, 2], tip.position)
        elif index == last:  # a leaning shank would meet the ground beside its point foot
            spare = min(_ABOVE_SOLE, 0.3 * float(np.linalg.norm(tip.position)))
            _cut(low, high, tip.position, tip.position, spare)
        elif index == leg.knee and abs(tip.rotation[:, 2] @ tip.position) < _ABOVE_SOLE:
            ankle = leg.chain.positions[leg.knee + 1]
            _cut(low, high, ankle, ankle, _ABOVE_ANKLE)
        if (high - low > 0.0).all():
            boxes.append(LinkBox(index, _box(low, high)))
    return tuple(boxes), tuple(_capsules(leg, {each.link: each.box for each in boxes}))


def _cut(
    low: np.ndarray, high: np.ndarray, way: np.ndarray, end: np.ndarray, spare: float = 0.0
) -> None:
    """Cut a box off in the direction of the axis nearest to `way`, `spare` before `end` [m]."""
    axis = int(np.argmax(np.abs(way)))
    if way[axis] < 0.0:
        low[axis] = max(low[axis], end[axis] + spare)
    else:
        high[axis] = min(high[axis], end[axis] - spare)


def _capsules(leg: Leg, boxes: Mapping[int, Box]) -> Iterable[Capsule]:
    """Yield the capsule along a foot with a sole, and that of the shank."""
    last = len(leg.chain) - 1
    if last in boxes and leg.flat:
        box = boxes[last]
        radius = round(min(0.5 * (box.high[1] - box.low[1]), 0.5 * (box.high[2] - box.low[2])), 3)
        height = round(box.low[2] + radius, _DIGITS)
        middle = round(0.5 * (box.high[1] + box.low[1]), _DIGITS) + 0.0
        back, front = round(box.low[0] + radius, _DIGITS), round(box.high[0] - radius, _DIGITS)
        if front > back:
            yield Capsule(last, (back, middle, height), (front, middle, height), radius)
    if leg.knee in boxes:
        box = boxes[leg.knee]
        end = leg.chain.positions[leg.knee + 1] if leg.knee < last else leg.chain.tip.position
        sides = [0.5 * (box.high[axis] - box.low[axis]) for axis in range(3)]
        along = int(np.argmax(np.abs(end)))
        radius = round(min(side for axis, side in enumerate(sides) if axis != along), 3)
        yield Capsule(leg.knee, (0.0, 0.0, 0.0), tuple((np.round(end, 6) + 0.0).tolist()), radius)
