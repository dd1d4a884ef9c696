"""Footsteps in a log: by heights of the feet (thesis, section 4.1.2) or by measured contact."""

from collections import Counter
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from jaxleas.footsteps.records import Definition, Footsteps
from jaxleas.footsteps.samples import Samples
from jaxleas.types import ControllerIdentity

LEVEL = 0.002
"""Greatest difference of heights between left and right foot, in front and behind: the thesis's
epsilon [m]. (Its formula, a signed difference of two differences, also holds where both pairs are
apart; its code tests each pair.)"""
TOUCHES = 5.0
"""Least force of a foot that is in contact [N]."""
SHORTEST = 0.5
"""Least time between the ends of two footsteps, over the shorter of the times of a swing [1]."""
APEX_TOLERANCE = 0.3
"""Greatest difference of a swing's apex from the set swing height, over that height [1]."""
SWUNG = 0.3
"""Least rise of a foot that swung, over the set swing height [1]."""
SWING_TIME = 0.25
"""Time of a swing of a controller that does not state its cycle and duty [s]."""


@dataclass(frozen=True, eq=False)
class Extracted:
    """The footsteps of one run.

    Attributes:
        footsteps: those kept.
        rejected: number of those that were not, by reason.
    """

    footsteps: Footsteps
    rejected: Counter[str]


def extract_footsteps(
    samples: Samples, run: int, controller: ControllerIdentity, definition: Definition
) -> Extracted:
    """Return the footsteps of one robot's log.

    A footstep ends at the first tick at which all feet stand again; the next one begins there. It
    is kept if one pair of the controller has swung in it, and nothing else, to about the set
    height, and it did not end too soon after the one before.

    Args:
        samples: log on level ground.
        run: number of the run.
        controller: controller that walked.
        definition: whether feet stand by their heights or by contact.
    """
    stand = _level(samples, controller) if definition == "thesis" else _touching(samples)
    ends = np.flatnonzero(stand & ~np.roll(stand, 1) & (np.arange(len(stand)) > 0))
    first = int(np.argmax(stand)) if stand.any() else 0
    shortest = SHORTEST * swing_time(controller)
    before, rejected, kept = first, Counter[str](), []
    for end in ends:
        if samples.time[end] - samples.time[before] < shortest:
            rejected["too soon after the one before"] += 1
            continue
        judged = _judge(samples.feet[before : end + 1, :, 2], controller)
        if isinstance(judged, str):
            rejected[judged] += 1
        else:
            kept.append((before, end, *judged))
        before = int(end)
    return Extracted(_footsteps(samples, run, kept), rejected)


def _level(samples: Samples, controller: ControllerIdentity) -> Bool[np.ndarray, " T"]:
    """Return where left and right feet are level, in front and behind."""
    heights = samples.feet[..., 2]
    rows = [(row, row + 1) for row in range(0, len(controller.feet), 2)]
    apart = np.stack([np.abs(heights[:, one] - heights[:, other]) for one, other in rows])
    return np.asarray((apart < LEVEL).all(axis=0))


def _touching(samples: Samples) -> Bool[np.ndarray, " T"]:
    return np.asarray((samples.forces > TOUCHES).all(axis=1))


def swing_time(controller: ControllerIdentity) -> float:
    """Return the time of a swing of a controller [s], a guess where it does not state it."""
    cycle, duty = (controller.settings.get(key) for key in ("cycle", "duty"))
    if isinstance(cycle, float) and isinstance(duty, float):
        return cycle * (1.0 - duty)
    return SWING_TIME


def _judge(
    heights: Float[np.ndarray, "T E"], controller: ControllerIdentity
) -> tuple[int, float] | str:
    """Return pair and apex of a footstep, or why it is none.

    Args:
        heights: heights of the feet from its beginning to its end [m].
        controller: controller that walked.
    """
    rises = (heights - heights[0]).max(axis=0)
    swung = tuple(np.flatnonzero(rises > SWUNG * controller.swing_height).tolist())
    pairs = [tuple(sorted(pair)) for pair in controller.pairs]
    if not swung:
        return "no foot swung"
    if swung not in pairs:
        return "not one pair alone swung"
    apex = float(rises[list(swung)].mean())
    if abs(apex - controller.swing_height) > APEX_TOLERANCE * controller.swing_height:
        return "apex far from the set height"
    return pairs.index(swung), apex


def _footsteps(samples: Samples, run: int, kept: list[tuple[int, int, int, float]]) -> Footsteps:
    before, after, pair = (
        np.array([each[column] for each in kept], dtype=int) for column in range(3)
    )
    return Footsteps(
        run=np.full(len(kept), run),
        time=samples.time[after],
        pair=pair,
        com_before=samples.com[before],
        com_after=samples.com[after],
        yaw_before=samples.yaw[before],
        yaw_after=samples.yaw[after],
        com_velocity_before=samples.com_velocity[before],
        com_velocity_after=samples.com_velocity[after],
        yaw_rate_before=samples.yaw_rate[before],
        yaw_rate_after=samples.yaw_rate[after],
        feet_before=samples.feet[before],
        feet_after=samples.feet[after],
        previous_command=samples.command[before],
        command=samples.command[(before + after) // 2],  # in force the longest where it changed
        apex=np.array([each[3] for each in kept], dtype=float),
    )
