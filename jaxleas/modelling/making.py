"""A robot from its sketch, by sampling its kinematics."""

from collections.abc import Callable, Sequence

import numpy as np

from jaxleas.geometry import Polytope
from jaxleas.modelling.hulls import simple_hull
from jaxleas.modelling.legs import Leg
from jaxleas.modelling.options import OF_HEIGHT, MakeOptions
from jaxleas.modelling.palms import make_palms
from jaxleas.modelling.sampling import Samples, Standing, draw_standing
from jaxleas.modelling.shapes import leg_shapes
from jaxleas.modelling.sketch import Sketch
from jaxleas.modelling.steps import SampledLeg, com_polytopes, com_reach, step_polytopes
from jaxleas.robots import Effector, Limb, LimbModel, Robot
from jaxleas.types import InputError

Progress = Callable[[int], None]
_WALKING = 0.93
"""Height of the root along guide paths, as a share of that in the reference stance."""
_START_HEIGHTS = (-0.2 / OF_HEIGHT, 0.06 / OF_HEIGHT)
_WINDOW = (0.65 / OF_HEIGHT, 0.45 / OF_HEIGHT)
_BESIDE = 2  # more feet than so many stand beside the root, not below it
_FEWEST = 200
"""Number of configurations that must stand."""


def make_robot(sketch: Sketch, name: str, options: MakeOptions, progress: Progress) -> Robot:
    """Return the robot, its kinematics sampled.

    Args:
        sketch: what is known before.
        name: name of the robot.
        options: choices for the robot.
        progress: told how many further configurations were drawn.

    Raises:
        InputError: hardly any configuration stands.
    """
    stance, height = sketch.stance, sketch.stance.height
    legs, models = stance.legs, sketch.models()
    sampled: list[SampledLeg] = []
    ranges: list[Polytope] = []
    for leg in legs:
        if leg.mirror_of is not None:
            one = sampled[leg.mirror_of]
            angles = one.angles * one.leg.chain.mirror_signs
            sampled.append(SampledLeg(leg, angles, one.soles * [1.0, -1.0, 1.0]))
            ranges.append(ranges[leg.mirror_of].mirrored())
            continue
        samples = _sampled(sketch, leg, options, progress)
        sampled.append(SampledLeg(leg, samples.angles, samples.soles))
        what = f"the range of motion of '{leg.link}'"
        ranges.append(simple_hull(samples.soles, options.within, what))
    half_width = max(leg.half_size[1] for leg in legs)
    steps = {}
    if len(legs) > 1:
        step = options.step_for(len(legs), height, half_width, _apart(legs))
        steps = step_polytopes(sampled, step, options.within)
        draws = (options.pairs, options.seed, options.within)
        steps |= com_polytopes(sampled, models, sketch.masses.body, steps, draws)
    full = _full_models(sketch, models, options)
    limbs = tuple(
        Limb(leg.limb, reach, _effector(leg, options), tuple(np.round(leg.sole, 4).tolist()), model)
        for leg, reach, model in zip(legs, ranges, full, strict=True)
    )
    palms = make_palms(sketch.tree, sketch.root, stance.angles, options)
    walking = options.walking_height or round(_WALKING * height, 3)
    soles = [leg.half_size for leg in legs if leg.flat]
    return Robot(
        name=name,
        limbs=(*limbs, *palms),
        trunk=sketch.trunk,
        root_height=height,
        walking_height=walking,
        mass=round(sketch.masses.total, 3),
        friction=options.friction,
        foot_half_size=soles[0] if soles else (0.0, 0.0),
        start_heights=options.start_heights or _two(_START_HEIGHTS, height),
        contact_window=options.contact_window or _two(_WINDOW, height),
        steps=steps,
        body=sketch.masses.body,
    )


def draws_of(sketch: Sketch, options: MakeOptions) -> int:
    """Return how many configurations `make_robot` reports to have drawn."""
    own = [leg for leg in sketch.stance.legs if leg.mirror_of is None]
    return len(own) * options.samples


def _sampled(sketch: Sketch, leg: Leg, options: MakeOptions, progress: Progress) -> Samples:
    """Return samples of a leg, enough of which stand."""
    standing = standing_of(sketch, leg, options)
    chain = leg.bent(options.least_bend)
    samples = draw_standing(chain, standing, options.samples, options.seed, progress)
    bottom = min(box.low[2] for box in sketch.trunk)
    if len(samples.soles) < _FEWEST:
        raise InputError(
            f"of {samples.drawn} configurations of the leg of '{leg.link}' {len(samples.soles)}"
            f" stand below the trunk, whose lowest box ends {-bottom:.3f} m below the root: lower"
            " least_bend, give the boxes of `trunk`, narrow the joints' limits (`limits`), or"
            " take more --samples"
        )
    return samples


def standing_of(sketch: Sketch, leg: Leg, options: MakeOptions) -> Standing:
    """Return what counts as standing for a leg.

    Soles stand below the trunk, on their own side of the root or across it by their half width at
    most (farther across they would meet the other leg), and not too far from the reference stance;
    but those of many feet, which stand beside the root, as far as to below it: R* looks there.

    Args:
        sketch: robot.
        leg: leg of it.
        options: choices for the robot.
    """
    reach, sole = options.reach_for(sketch.stance.height), leg.sole
    bottom = min(box.low[2] for box in sketch.trunk)
    near, far = -leg.half_size[1], abs(float(sole[1])) + reach.outward
    sides = (near, far) if leg.side > 0 else (-far, -near)
    back, ahead = float(sole[0]) - reach.back, float(sole[0]) + reach.ahead
    if len(sketch.stance.legs) > _BESIDE and options.reach is None:
        back, ahead = min(back, 0.0), max(ahead, 0.0)
    return Standing(
        np.deg2rad(options.most_tilt) if leg.flat else None,
        bottom - options.clearance,
        (back, sides[0]),
        (ahead, sides[1]),
    )


def _full_models(
    sketch: Sketch, models: Sequence[LimbModel], options: MakeOptions
) -> list[LimbModel]:
    """Return the models of the legs with their shapes and their reach of the centre of mass."""
    full: list[LimbModel] = []
    com, height = sketch.com, sketch.stance.height
    draws = (
        *(options.least_bend_of_com, np.deg2rad(options.most_tilt)),
        *(max(options.samples // 4, 5000), options.seed),
    )
    for leg, model in zip(sketch.stance.legs, models, strict=True):
        if leg.mirror_of is not None:
            full.append(full[leg.mirror_of].mirrored())
            continue
        boxes, capsules = leg_shapes(sketch.tree, sketch.root, leg)
        full.append(
            LimbModel(
                *(leg.chain, leg.reference, model.link_mass, model.link_com),
                *(boxes, capsules, com_reach(leg, com, height, draws)),
            )
        )
    return full


def _effector(leg: Leg, options: MakeOptions) -> Effector:
    kind = "foot" if leg.flat else "point_foot"
    return Effector(leg.foot, kind, leg.half_size, options.friction, None, leg.link, leg.chain.tip)


def _apart(legs: Sequence[Leg]) -> float:
    """Return the distance of the nearest two feet side by side, or one behind the other [m]."""
    gaps = [
        abs(float((one.sole - other.sole)[1 if one.side != other.side else 0]))
        for index, one in enumerate(legs)
        for other in legs[:index]
    ]
    return min(gaps)


def _two(shares: tuple[float, float], height: float) -> tuple[float, float]:
    return (round(shares[0] * height, 3), round(shares[1] * height, 3))
