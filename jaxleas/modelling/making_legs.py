"""From a URDF and the choices for a robot to its legs and its reference stance."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from jaxleas.modelling.feet import Foot, Say
from jaxleas.modelling.legs import Leg, is_mirror_image, limb_names, order_of, straight_knee
from jaxleas.modelling.options import MakeOptions
from jaxleas.modelling.stance import CROUCHED, UPRIGHT, Target, require_stance, stretched_height
from jaxleas.modelling.tree import UrdfTree
from jaxleas.robots import chain_posture
from jaxleas.types import InputError


@dataclass(frozen=True, eq=False)
class Stance:
    """The legs, and all joints, of a robot that stands.

    Attributes:
        legs: legs, left before right.
        angles: values of all joints of the URDF, by name.
        height: height of the root above the soles [m].
    """

    legs: tuple[Leg, ...]
    angles: Mapping[str, float]
    height: float


def make_stance(
    tree: UrdfTree,
    root: str,
    options: MakeOptions,
    say: Say,
    near: Mapping[str, float] | None = None,
) -> Stance:
    """Return the legs of a robot and its reference stance.

    Args:
        tree: links of the robot.
        root: name of the root's link.
        options: choices for the robot.
        say: told what was found instead of stated.
        near: angles of joints, by name, that the stance is to be near to [rad]; None for 0.

    Raises:
        InputError: says which choice is missing or contradicts the URDF.
    """
    angles = tree.neutral(options.reference)
    held = _held(tree, root, options, angles, say)
    feet = [Foot.found(tree, (root, link), options, (angles, held)) for link in options.feet]
    for moved in dict.fromkeys(each.moved for each in feet if each.moved):
        links = [f"'{each.link}'" for each in feet if each.moved == moved]
        say(f"the frame of {', '.join(links)} is {moved}")
    places = np.array([each.neutral for each in feet])
    order = order_of(places)
    if order != list(range(len(feet))):
        named = [options.feet[index] for index in order]
        say(
            f"feet are taken in the order {' '.join(named)}: left before right, front before hind,"
            " as the root has x ahead and y left (--root names a link that has)"
        )
    feet = [feet[index] for index in order]
    names = limb_names(places[order], tuple(each.link for each in feet))
    height = _height(feet, options, say)
    legs: list[Leg] = []
    for foot, (limb, name) in zip(feet, names, strict=True):
        before = list(zip(feet, legs, strict=False))
        legs.append(_leg(foot, (limb, name), before, (height, near), options))
    for leg in legs:
        angles |= dict(zip(leg.chain.names, leg.reference.tolist(), strict=True))
    return Stance(tuple(legs), angles, height)


def _held(
    tree: UrdfTree, root: str, options: MakeOptions, angles: Mapping[str, float], say: Say
) -> dict[str, float]:
    """Return the angles of joints that several limbs have in common, which do not move."""
    paths = [{j.name for j in tree.path_to(link, root)} for link in options.feet]
    moving = {j.name for j in tree.joints if j.kind != "fixed"}
    shared = sorted(
        name for name in moving & set().union(*paths) if sum(name in path for path in paths) > 1
    )
    if shared:
        say(f"joints that legs have in common do not move: {', '.join(shared)}")
    return {name: angles[name] for name in shared}


def _height(feet: list[Foot], options: MakeOptions, say: Say) -> float:
    """Return the height of the root in the reference stance [m]."""
    stated = [
        chain_posture(each.chain, each.stated).tip[2] for each in feet if each.stated is not None
    ]
    if stated:
        if max(stated) - min(stated) > 0.01:
            raise InputError(
                f"in the stated reference stance the soles are {max(stated) - min(stated):.3f} m"
                " apart in height: a foot frame is not at its sole, or an angle is wrong"
            )
        found = -float(np.mean(stated))
        if options.root_height is not None and abs(found - options.root_height) > 0.01:
            raise InputError(
                f"root_height is {options.root_height:g} m, but in the stated reference stance the"
                f" soles are {found:.3f} m below the root: a foot frame is not at its sole, or one"
                " of both is wrong"
            )
        return options.root_height or round(found, 4)
    if options.root_height is not None:
        return options.root_height
    heights = [stretched_height(each.chain, each.flat, each.neutral[:2]) for each in feet]
    if not np.isfinite(heights).all() or min(heights) <= 0.0:
        link = feet[int(np.argmin(np.nan_to_num(heights, nan=-np.inf)))].link
        raise InputError(
            f"no posture brings the sole of '{link}' level below its hip: is its frame upright?"
            " state root_height and reference_sole, or the angles of a stance by `reference`"
        )
    share = UPRIGHT if len(feet) <= 2 and all(each.flat for each in feet) else CROUCHED
    height = round(share * min(heights), 3)
    say(f"the root stands {height:g} m high, {share:.0%} of stretched legs (--root-height)")
    return height


def _leg(
    foot: Foot,
    names: tuple[str, str],
    before: Sequence[tuple[Foot, Leg]],
    stance: tuple[float, Mapping[str, float] | None],
    options: MakeOptions,
) -> Leg:
    """Return the leg of a foot, standing at a height, near to a posture."""
    height, near = stance
    images = (k for k, (each, _) in enumerate(before) if is_mirror_image(each.whole, foot.whole))
    image = next((k for k in images if before[k][1].mirror_of is None), None)
    chain, straight = foot.chain, options.straight_knee
    one = None if image is None else before[image][1]
    if one is not None:
        chain = replace(one.chain.mirrored(), names=foot.chain.names)
        straight = float(one.straight * one.chain.mirror_signs[one.knee]) + 0.0
    if straight is None:
        straight = straight_knee(chain)
    if foot.stated is not None:
        angles = np.round(foot.stated, 6)
    elif one is not None:
        angles = one.reference * one.chain.mirror_signs + 0.0
    else:
        x, y = foot.neutral[:2].tolist()
        if options.reference_sole is not None:
            x, y = options.reference_sole[0], float(np.copysign(options.reference_sole[1], y))
        posture = None if near is None else np.array([near[name] for name in chain.names])
        target = Target(chain, foot.flat, np.array([x, y, -height]), posture)
        angles = np.round(require_stance(target, foot.link), 6)
    angles = np.clip(angles, chain.lower, chain.upper)
    return Leg(*names, foot.link, chain, foot.flat, foot.half_size, angles, straight, image)
