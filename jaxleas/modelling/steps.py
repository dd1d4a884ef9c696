"""Where a foot and the centre of mass can be from a standing foot, over sampled stances."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from jaxleas.geometry import Polytope
from jaxleas.modelling.hulls import hull_of_26, negated, simple_hull
from jaxleas.modelling.legs import Leg
from jaxleas.modelling.options import Step
from jaxleas.robots import Body, LimbModel, chain_posture
from jaxleas.types import InputError

_TRIES = 50
_MIRROR = np.array([1.0, -1.0, 1.0])
_LOWEST_OF_COM = 0.4 / 1.0198
"""Least height of the root above a foot for which the centre of mass is looked for, as a share of
the height of the reference stance."""


@dataclass(frozen=True, eq=False)
class SampledLeg:
    """A leg and its samples: angles [rad] and middles of soles [m] of configurations that stand."""

    leg: Leg
    angles: Float[np.ndarray, "M J"]
    soles: Float[np.ndarray, "N 3"]


def step_polytopes(legs: Sequence[SampledLeg], step: Step, within: float) -> dict[str, Polytope]:
    """Return "X_in_Y", where foot X can be from foot Y such that one root reaches both.

    The differences of the corners of the two legs' hulls (their Minkowski difference, hence
    convex), cut to the longest step and to feet that do not stand on each other. Frames are
    parallel to the root's: along a guide path a foot lands with the root's heading.

    Args:
        legs: legs and their samples.
        step: longest step, and least distance of feet.
        within: how far the polytopes may reach beyond the differences [m].

    Raises:
        InputError: two feet cannot stand at the same time.
    """
    made: dict[str, Polytope] = {}
    hulls = [Polytope.from_points(each.soles).vertices for each in legs]
    for i, standing in enumerate(legs):
        for j in range(i + 1, len(legs)):
            one, other = standing.leg, legs[j].leg
            differences = (hulls[j][:, None, :] - hulls[i][None, :, :]).reshape(-1, 3)
            name = f"{other.foot}_in_{one.foot}"
            cut = Polytope.from_points(differences).cut(*_cut(one, other, step))
            try:
                corners = cut.vertices
            except InputError as error:
                raise InputError(
                    f"{other.foot} and {one.foot} cannot stand at the same time with steps of at"
                    f" most {step.longest:g} m and feet {step.apart:g} m apart: state a longer"
                    " `step.longest` or a smaller `step.apart`"
                ) from error
            made[name] = simple_hull(corners, within, name)
            made[f"{one.foot}_in_{other.foot}"] = negated(made[name])
    return made


def _cut(one: Leg, other: Leg, step: Step) -> tuple[np.ndarray, np.ndarray]:
    """Return the half-spaces of a step of `other` as seen from `one`."""
    x, y, _ = other.sole - one.sole
    normals, offsets = [[1.0, 0, 0], [-1, 0, 0]], [x + step.longest, step.longest - x]
    if one.side != other.side:
        normals.append([0.0, -np.sign(y), 0.0])
    else:
        normals.append([-np.sign(x) or 1.0, 0.0, 0.0])
    return np.array(normals), np.array([*offsets, -step.apart])


def com_polytopes(
    legs: Sequence[SampledLeg],
    models: Sequence[LimbModel],
    body: Body,
    steps: dict[str, Polytope],
    draws: tuple[int, int, float],
) -> dict[str, Polytope]:
    """Return "COM_in_Y", where the centre of mass can be from foot Y, over random stances.

    A stance is a configuration of each leg such that each pair of feet makes a step.

    Args:
        legs: legs and their samples.
        models: joints and masses of the legs.
        body: all that is no leg.
        steps: what a step is.
        draws: number of stances, seed, and how far the polytopes may reach beyond them [m].

    Raises:
        InputError: hardly any stance is found.
    """
    count, seed, within = draws
    rng, kept, found = np.random.default_rng(seed), [], 0
    for _ in range(_TRIES):
        some = np.stack([rng.integers(len(each.angles), size=4 * count) for each in legs])
        soles = [each.soles[rows] for each, rows in zip(legs, some, strict=True)]
        allowed = np.ones(4 * count, dtype=bool)
        for i, one in enumerate(legs):
            for j in range(i + 1, len(legs)):
                reach = steps[f"{legs[j].leg.foot}_in_{one.leg.foot}"]
                allowed &= reach.contains(soles[j] - soles[i])
        kept.append(some[:, allowed])
        found += int(allowed.sum())
        if found >= count:
            break
    rows = np.concatenate(kept, axis=1)[:, :count]
    com = _centres(legs, models, body, rows)
    made: dict[str, Polytope] = {}
    for index, each in enumerate(legs):
        name, image = f"COM_in_{each.leg.foot}", each.leg.mirror_of
        if image is not None:
            made[name] = made[f"COM_in_{legs[image].leg.foot}"].mirrored()
        else:
            made[name] = simple_hull(com - each.soles[rows[index]], within, name)
    return made


def _centres(
    legs: Sequence[SampledLeg], models: Sequence[LimbModel], body: Body, rows: np.ndarray
) -> Float[np.ndarray, "N 3"]:
    """Return the centre of mass of the whole robot in the root frame for each stance [m]."""
    mass = body.mass + sum(float(each.link_mass.sum()) for each in models)
    moment = np.tile(body.mass * body.com, (rows.shape[1], 1))
    for each, model, some in zip(legs, models, rows, strict=True):
        for start in range(0, len(some), 4000):
            part = slice(start, start + 4000)
            posture = chain_posture(model.chain, each.angles[some[part]])
            moment[part] += model.mass_moment(posture.frames, posture.origins)
    return moment / mass


def com_reach(
    leg: Leg, com: Float[np.ndarray, " 3"], height: float, draws: tuple[float, float, int, int]
) -> Polytope:
    """Return the hull of the reference centre of mass in the frame of a standing foot.

    The frame is turned by the foot's yaw alone; the hull has 26 faces.

    Args:
        leg: leg that stands.
        com: centre of mass of the whole robot in the root frame, in the reference stance [m].
        height: height of the root in that stance [m].
        draws: least bend of the knee and largest slope of a sole [rad], number of configurations
            and seed.

    Raises:
        InputError: no configuration stands.
    """
    bend, tilt, count, seed = draws
    chain, seen = leg.bent(bend), []
    rng, left = np.random.default_rng(seed), count
    while left > 0:
        drawn = rng.uniform(chain.lower, chain.upper, (min(left, 4000), len(chain)))
        left -= len(drawn)
        posture = chain_posture(chain, drawn)
        keep = posture.tip[:, 2] <= -_LOWEST_OF_COM * height
        keep &= leg.side * posture.tip[:, 1] >= -leg.half_size[1]
        if leg.flat:
            keep &= posture.tip_rotation[:, 2, 2] >= np.cos(tilt)
        rotation = posture.tip_rotation[keep]
        yaw = np.arctan2(rotation[:, 1, 0], rotation[:, 0, 0]) if leg.flat else 0.0
        x, y, z = (com - posture.tip[keep]).T
        cosine, sine = np.cos(yaw), np.sin(yaw)
        seen.append(np.stack([cosine * x + sine * y, cosine * y - sine * x, z], axis=1))
    points = np.concatenate(seen)
    if len(points) < 5:
        raise InputError(
            f"no configuration of the leg of '{leg.link}' stands: are its limits right?"
        )
    return hull_of_26(points)
