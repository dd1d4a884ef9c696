"""What a phase tracker follows, from a plan: curves with the largest margins, swings, times."""

from dataclasses import replace

import numpy as np
from jaxtyping import Float

from jaxleas.controllers import Heights, PhaseTracks, plan_swings
from jaxleas.envs.gait_planning import in_contact
from jaxleas.gaits.gait import taken
from jaxleas.gaits.gait_plan import GaitPlan
from jaxleas.gaits.tracked_programs import TrackedMargins, tracked_margins
from jaxleas.types import InputError

QUICKER = (2.5, 2.0, 1.6, 1.3)
"""How many times as fast as planned a transition may be; the fastest are tried first."""


def quickened(plan: GaitPlan, most: float, keeps: float = 0.8) -> GaitPlan:
    """Return a plan whose transitions take less time where their programs allow it.

    Args:
        plan: plan.
        most: most times as fast as planned.
        keeps: share of a transition's margin that it must keep.
    """
    allowed = [speed for speed in QUICKER if speed <= most]
    if not plan.length or not allowed:
        return plan
    planned = _solved(plan, plan.times).margin
    times, done = plan.times.copy(), np.zeros(plan.length, bool)
    for speed in allowed:
        margin = _solved(plan, plan.times / speed).margin
        good = ~done & (margin >= keeps * planned)
        times[good] = plan.times[good] / speed
        done |= good
    return replace(plan, times=times)


def track_of(plan: GaitPlan, heights: Heights, over: tuple[float, float]) -> PhaseTracks:
    """Return what a tracker follows of a plan, with an axis of one robot in front.

    Args:
        plan: plan.
        heights: heights of the ground, read along each swing.
        over: radius of a foot, and height of a swing above all that is on its way [m].

    Raises:
        InputError: the plan has no transition, or begins with a foot in the air.
    """
    if not plan.length:
        raise InputError("the plan has no transition: there is nothing to track")
    phases = plan.phases
    stands = in_contact(phases.support)
    if not stands[0].all():
        raise InputError("the plan's first phase has a foot in the air: begin with all four down")
    feet = phases.feet.astype(np.float64) + np.array([0.0, 0.0, over[0]])
    lasts = plan.times.sum(axis=1)
    begins = np.concatenate([[0.0], np.cumsum(lasts)])
    switches = np.concatenate([[0.0], begins[:-1] + plan.times[:, 1]])
    return PhaseTracks(
        lengths=np.array([plan.length]),
        begins=begins[None],
        switches=switches[None],
        curves=_curves(plan, lasts)[None],
        yaws=np.unwrap(phases.yaw.astype(np.float64))[None],
        stands=stands[None],
        feet=feet[None],
        swings=plan_swings(stands, feet, np.append(switches, begins[-1]), heights, over),
    )


def _curves(plan: GaitPlan, lasts: Float[np.ndarray, " K"]) -> Float[np.ndarray, "K 5 3"]:
    """Return the control points of the centre of mass.

    Free points are those of the largest margins, but for their height, which is halfway between the
    ends': the margin grows where the trunk crouches, since the legs reach farther then.
    """
    com = plan.phases.com.astype(np.float64)
    velocity = np.zeros_like(com)
    velocity[:, :2] = plan.phases.velocity
    step = lasts[:, None] / 4.0
    free = _solved(plan, plan.times).free_point.copy()
    free[:, 2] = 0.5 * (com[:-1, 2] + com[1:, 2])
    points = [com[:-1], com[:-1] + step * velocity[:-1], free]
    points += [com[1:] - step * velocity[1:], com[1:]]
    return np.stack(points, axis=1)


def _solved(plan: GaitPlan, times: Float[np.ndarray, "K 2"]) -> TrackedMargins:
    before, after = taken(plan.phases, slice(None, -1)), taken(plan.phases, slice(1, None))
    return tracked_margins(plan, before, after, times)
