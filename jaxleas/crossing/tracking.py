"""Robots that follow gait plans in physics, until the end of the plan, a fall, or a time."""

from dataclasses import dataclass, field, replace

import numpy as np
from jaxtyping import Float

from jaxleas.controllers import FALLS, TICK, UPRIGHT, PhaseTracker, Walk, Walking, falls
from jaxleas.crossing.crossing import Observer
from jaxleas.crossing.followed_plan import Followed, Tracking
from jaxleas.crossing.foothold_scores import FootholdLog, landing_errors, tracked_footholds
from jaxleas.footsteps import TOUCHES
from jaxleas.physics import BodyState
from jaxleas.types import InputError

EVERY = 5
"""Ticks between two instants that are kept, and at which ends are looked for: 20 ms."""
RESTS = 0.5
"""Time that a robot must stand after its plan's end [s]."""
AT_END = 0.1
"""Horizontal distance of the centre of mass from its place at the plan's end within which the plan
was followed [m]."""


@dataclass(frozen=True, eq=False)
class _End:
    """How a robot's walk ended: what `Tracking` says, and the number of instants until then."""

    outcome: Followed
    time: float
    support: int
    com: Float[np.ndarray, "3"]
    cause: str = ""
    instants: int | None = None


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
    kept, ended = _Kept(), dict[int, _End]()
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
        _tracking(index, tracker, kept, ended.get(index) or _now(last, walking, index))
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
    ended: dict[int, _End],
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
    com = walking.sensed.com
    apart = np.hypot(*(com - goal)[:, :2].T)
    for index in np.flatnonzero((causes != UPRIGHT) | done).tolist():
        if index in ended:
            continue
        now, number = float(walking.sensed.time[index]), int(support[index])
        if causes[index] != UPRIGHT:
            ended[index] = _End("fell", now, number, com[index], FALLS[causes[index]], instants)
        else:
            how: Followed = "followed" if apart[index] <= AT_END else "astray"
            ended[index] = _End(how, now, number, com[index], "", instants)


def _aside(walking: Walking, ended: dict[int, _End], start: BodyState) -> Walking:
    """Put robots that lie back to where they began, with other robots about: they may diverge."""
    down = np.array(
        [index in ended and ended[index].outcome == "fell" for index in range(len(start))]
    )
    if down.any() and len(start) > 1:
        return replace(walking, state=walking.state.replaced(down, start))
    return walking


def _now(outcome: Followed, walking: Walking, index: int) -> _End:
    sensed = walking.sensed
    return _End(outcome, float(sensed.time[index]), -1, sensed.com[index])


def _tracking(
    index: int,
    tracker: PhaseTracker,
    kept: _Kept,
    end: _End,
) -> Tracking:
    supports, wanted, planned, feet, touching, errors = (
        np.array([each[index] for each in rows[: end.instants]])
        for rows in (
            *(kept.supports, kept.stands, kept.planned, kept.feet, kept.touching),
            kept.base_errors,
        )
    )
    log = FootholdLog(supports, wanted, planned, feet, touching)
    length = int(tracker.tracks.lengths[index])
    stands = tracker.tracks.stands[index, : length + 1]
    scores = tracked_footholds(log, stands), landing_errors(log, stands)
    last = int(supports[-1]) if len(supports) else 0
    support = last if end.support < 0 else end.support
    return Tracking(end.outcome, end.time, support, end.cause, end.com, errors, *scores, log)
