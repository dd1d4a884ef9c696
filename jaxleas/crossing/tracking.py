"""Robots that follow gait plans in physics, until the end of the plan, a fall, or a time."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Literal, get_args

import numpy as np
from jaxtyping import Bool, Float

from jaxleas.controllers import FALLS, TICK, UPRIGHT, PhaseTracker, Walk, Walking, falls
from jaxleas.crossing.crossing import Observer
from jaxleas.crossing.foothold_scores import (
    FootholdLog,
    foothold_tracking_error,
    landing_errors,
    tracked_footholds,
)
from jaxleas.footsteps import TOUCHES
from jaxleas.physics import BodyState
from jaxleas.types import InputError

Followed = Literal["followed", "astray", "fell", "time", "interrupted"]
"""It stands at the end of its plan; it stands elsewhere; it fell; its time was over before; a
person stopped it."""
FOLLOWED: tuple[Followed, ...] = get_args(Followed)
EVERY = 5
"""Ticks between two instants that are kept, and at which ends are looked for: 20 ms."""
RESTS = 0.5
"""Time that a robot must stand after its plan's end [s]."""
AT_END = 0.1
"""Horizontal distance of the centre of mass from its place at the plan's end within which the plan
was followed [m]."""


@dataclass(frozen=True, eq=False)
class Tracking:
    """What became of one robot that follows a plan.

    Attributes:
        outcome: how it ended.
        time: time of the end [s].
        support: number of the plan's support in which it ended.
        cause: what showed a fall, one of `jaxleas.controllers.FALLS`; "" otherwise.
        com: last position of the centre of mass [m].
        base_errors: distance of the centre of mass from its place at each instant [m].
        tracked: whether each new foothold of the plan was tracked.
        landing_errors: horizontal distances of landed feet from their new footholds [m].
        log: what was planned of its feet, and measured.
    """

    outcome: Followed
    time: float
    support: int
    cause: str
    com: Float[np.ndarray, "3"]
    base_errors: Float[np.ndarray, " T"]
    tracked: Bool[np.ndarray, " F"]
    landing_errors: Float[np.ndarray, " G"]
    log: FootholdLog

    @property
    def fter(self) -> float:
        """Mean distance of standing feet from their footholds: `foothold_tracking_error` [m]."""
        return foothold_tracking_error(self.log)

    @property
    def fts(self) -> float:
        """Share of the plan's new footholds that were tracked; 1 of a plan without any."""
        return float(self.tracked.mean()) if len(self.tracked) else 1.0


@dataclass(eq=False)
class _Kept:
    """What is kept of all robots at one instant."""

    supports: list[np.ndarray] = field(default_factory=list)
    stands: list[np.ndarray] = field(default_factory=list)
    planned: list[np.ndarray] = field(default_factory=list)
    feet: list[np.ndarray] = field(default_factory=list)
    touching: list[np.ndarray] = field(default_factory=list)
    base_errors: list[np.ndarray] = field(default_factory=list)


def track(
    walk: Walk, start: BodyState, seconds: float, observe: Observer | None = None
) -> list[Tracking]:
    """Let robots follow their plans until each has come to its end, fell, or its time is over.

    Args:
        walk: a phase tracker in physics.
        start: robots that stand on the feet of their plans' first phases.
        seconds: longest time [s].
        observe: function that looks at each tick; Ctrl-C ends the walk, and what was observed
            stays.

    Raises:
        InputError: the controller is no phase tracker, or one of another number of robots.
    """
    tracker = walk.controller
    if not isinstance(tracker, PhaseTracker) or len(tracker.tracks) != len(start):
        raise InputError(
            f"tracking needs a PhaseTracker with a plan for each of {len(start)} robots"
        )
    kept, ended = _Kept(), dict[int, tuple[Followed, float, int, str, int]]()
    walking, still = walk.begin(start), np.zeros((len(start), 3))
    last: Followed = "time"
    try:
        for tick in range(round(seconds / TICK)):
            if tick % EVERY == 0:
                _keep(kept, tracker, walking)
                _end(ended, walk, tracker, walking, len(kept.supports))
            if len(ended) == len(start):
                break
            ticked = walk.tick(walking, still)
            if observe is not None:
                observe(ticked, still)
            walking = _aside(ticked.walking, ended, start)
    except KeyboardInterrupt:
        last = "interrupted"
    return [
        _tracking(index, tracker, kept, walking, ended.get(index) or _now(last, walking, index))
        for index in range(len(start))
    ]


def _keep(kept: _Kept, tracker: PhaseTracker, walking: Walking) -> None:
    reference, sensed = tracker.tracks.at(walking.memory.time), walking.sensed
    rows = np.arange(len(tracker.tracks))
    kept.supports.append(reference.support)
    kept.stands.append(reference.stands)
    kept.planned.append(tracker.tracks.feet[rows, reference.support])
    kept.feet.append(sensed.feet)
    kept.touching.append(sensed.forces > TOUCHES)
    kept.base_errors.append(np.linalg.norm(reference.com - sensed.com, axis=1))


def _end(
    ended: dict[int, tuple[Followed, float, int, str, int]],
    walk: Walk,
    tracker: PhaseTracker,
    walking: Walking,
    instants: int,
) -> None:
    """Note which robots fell, or came to the end of their plans."""
    causes = falls(walk.physics.body, walking.state, walking.sensed)
    support = tracker.tracks.at(walking.memory.time).support
    done = walking.memory.time >= tracker.tracks.ends + RESTS
    goal = tracker.tracks.at(tracker.tracks.ends).com
    apart = np.hypot(*(walking.sensed.com - goal)[:, :2].T)
    for index in np.flatnonzero((causes != UPRIGHT) | done).tolist():
        if index in ended:
            continue
        now, number = float(walking.sensed.time[index]), int(support[index])
        if causes[index] != UPRIGHT:
            ended[index] = "fell", now, number, FALLS[causes[index]], instants
        else:
            how: Followed = "followed" if apart[index] <= AT_END else "astray"
            ended[index] = how, now, number, "", instants


def _aside(
    walking: Walking, ended: dict[int, tuple[Followed, float, int, str, int]], start: BodyState
) -> Walking:
    """Put robots that lie back to where they began, with other robots about: they may diverge."""
    down = np.array([ended.get(index, ("",))[0] == "fell" for index in range(len(start))])
    if down.any() and len(start) > 1:
        return replace(walking, state=walking.state.replaced(down, start))
    return walking


def _now(
    outcome: Followed, walking: Walking, index: int
) -> tuple[Followed, float, int, str, int | None]:
    return outcome, float(walking.sensed.time[index]), -1, "", None


def _tracking(
    index: int,
    tracker: PhaseTracker,
    kept: _Kept,
    walking: Walking,
    ended: Sequence,
) -> Tracking:
    outcome, time, support, cause, instants = ended
    supports, wanted, planned, feet, touching, errors = (
        np.array([each[index] for each in rows[:instants]])
        for rows in (
            *(kept.supports, kept.stands, kept.planned, kept.feet, kept.touching),
            kept.base_errors,
        )
    )
    log = FootholdLog(supports, wanted, planned, feet, touching)
    length = int(tracker.tracks.lengths[index])
    stands = tracker.tracks.stands[index, : length + 1]
    scores = tracked_footholds(log, stands), landing_errors(log, stands)
    if support < 0:
        support = int(supports[-1]) if len(supports) else 0
    com = walking.sensed.com[index]
    return Tracking(outcome, time, support, cause, com, errors, *scores, log)
