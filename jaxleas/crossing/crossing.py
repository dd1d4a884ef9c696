"""Closed loop: robots walk in physics, and each gets a new command at each of its contacts."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Protocol

import numpy as np
from jaxtyping import Float

from jaxleas.controllers import FALLS, TICK, UPRIGHT, Controller, Ticked, Walk, Walking, falls
from jaxleas.crossing.commanders import Commander, Decision
from jaxleas.crossing.first_pair import first_pair
from jaxleas.crossing.outcomes import Crossing, Outcome
from jaxleas.crossing.stop import RESTS
from jaxleas.crossing.taking_turns import take_turns
from jaxleas.crossing.walked_footsteps import WalkedFootstep, first_of
from jaxleas.footsteps import NONE, TOUCHES, ContactWatch, FootstepPlan, WalkingState
from jaxleas.physics import Body, BodyState, Sensed
from jaxleas.types import InputError

SETTLES = 0.4
"""Time from the command to stand until a robot is asked whether it rests [s]."""
LATE = 1.0
"""Time after which a walking robot is commanded anew although no footstep has ended [s]."""


class Observer(Protocol):
    """Looks at all that happens."""

    def __call__(self, ticked: Ticked, command: Float[np.ndarray, "N 3"]) -> None:
        """Look at one tick, and the commands during it."""
        ...


@dataclass(eq=False)
class _Robot:
    """What is known of one robot while it walks.

    Attributes:
        commander: who decides for it.
        pair: index of the pair that is expected to swing next.
        decision: last decision.
        decided: time of the last decision [s].
        earlier: command before the last decision.
    """

    commander: Commander
    pair: int
    decision: Decision | None = None
    decided: float = -np.inf
    earlier: Float[np.ndarray, "3"] = field(default_factory=lambda: np.zeros(3))
    footsteps: list[WalkedFootstep] = field(default_factory=list)
    seconds: list[float] = field(default_factory=list)
    ended: tuple[Outcome, float, str] | None = None


def cross(
    walk: Walk,
    start: BodyState,
    commanders: Sequence[Commander],
    seconds: float,
    observe: Observer | None = None,
    rng: np.random.Generator | None = None,
) -> list[Crossing]:
    """Walk robots from a start until each has arrived, has no path, fell, or its time is over.

    At each measured contact the state is measured, the commander decides, and its command holds
    until the next contact. Deciding takes no time in physics; how long it took is recorded.

    Args:
        walk: controller in physics.
        start: robots that stand.
        commanders: who decides for each robot.
        seconds: longest time of a walk [s].
        observe: function that looks at each tick; Ctrl-C ends the walk, and what was observed
            stays.
        rng: source of the torques' noise; None for no noise.
    """
    if len(commanders) != len(start):
        raise InputError(f"{len(commanders)} commanders are given for {len(start)} robots")
    pair = first_pair(walk.physics.body, walk.controller)
    robots = [_Robot(each, pair) for each in commanders]
    walking = walk.begin(start)
    watch = ContactWatch(walk.controller.identity, len(start))
    try:
        for _ in range(round(seconds / TICK)):
            ended = watch.update(walking.sensed)
            for index, robot in enumerate(robots):
                if robot.ended is None:
                    _attend(robot, index, walking, int(ended[index]), walk.controller)
            if all(robot.ended for robot in robots):
                break
            walking, begun = take_turns(walking, [_plan(each) for each in robots], walk.controller)
            for index in begun:
                robots[index].pair = pair
            command = np.stack([_command(robot) for robot in robots])
            ticked = walk.tick(walking, command, rng)
            if observe is not None:
                observe(ticked, command)
            walking = _without_fallen(ticked.walking, robots, start, walk.physics.body)
        last: Outcome = "time"
    except KeyboardInterrupt:
        last = "interrupted"
    now = float(walking.sensed.time.max())
    return [
        _crossing(robot, walking.sensed, index, (last, now, ""))
        for index, robot in enumerate(robots)
    ]


def _attend(
    robot: _Robot, index: int, walking: Walking, ended: int, controller: Controller
) -> None:
    """Note a footstep that ended, and decide where it is time to."""
    sensed, pairs = walking.sensed, len(controller.identity.pairs)
    now = float(sensed.time[index])
    if ended != NONE:
        robot.footsteps.append(_walked(robot, index, sensed, ended))
        robot.pair = ((ended if ended >= 0 else robot.pair) + 1) % pairs
    waited = now - robot.decided
    goes = robot.decision is None or robot.decision.intent == "go"
    rests = not goes and waited >= SETTLES and _rests(sensed, index)
    if not (ended != NONE or robot.decision is None or rests or waited >= LATE):
        return
    decision = robot.commander.decide(_state(robot, index, sensed))
    robot.earlier = _command(robot)
    robot.decision, robot.decided = decision, now
    robot.seconds.append(decision.seconds)
    if rests and decision.intent != "go":
        robot.ended = ("reached" if decision.intent == "arrived" else "no path", now, "")


def _rests(sensed: Sensed, index: int) -> bool:
    speed = float(np.linalg.norm(sensed.com_velocity[index]))
    return speed < RESTS and bool((sensed.forces[index] > TOUCHES).all())


def _command(robot: _Robot) -> Float[np.ndarray, "3"]:
    return np.zeros(3) if robot.decision is None or robot.ended else robot.decision.command


def _plan(robot: _Robot) -> FootstepPlan | None:
    """Return the plan that is walked now."""
    return None if robot.decision is None or robot.ended else robot.decision.plan


def _state(robot: _Robot, index: int, sensed: Sensed) -> WalkingState:
    return WalkingState(
        com=sensed.com[index],
        yaw=float(sensed.yaw[index]),
        com_velocity=sensed.com_velocity[index],
        yaw_rate=float(sensed.turning_rate[index, 2]),
        feet=sensed.feet[index],
        pair=robot.pair,
        command=_command(robot),
        earlier=robot.earlier,
    )


def _walked(robot: _Robot, index: int, sensed: Sensed, ended: int) -> WalkedFootstep:
    plan = None if robot.decision is None else robot.decision.plan
    return WalkedFootstep(
        time=float(sensed.time[index]),
        pair=ended if ended >= 0 else None,
        expected=robot.pair,
        command=_command(robot),
        feet=sensed.feet[index],
        com=sensed.com[index],
        yaw=float(sensed.yaw[index]),
        planned=first_of(plan),
        controller="" if plan is None else plan.controller,
    )


def _without_fallen(
    walking: Walking, robots: Sequence[_Robot], start: BodyState, body: Body
) -> Walking:
    """End the walks of robots that fell, and put those that lie aside: they may diverge."""
    causes = falls(body, walking.state, walking.sensed)
    for index in np.flatnonzero(causes != UPRIGHT).tolist():
        robot = robots[index]
        if robot.ended is None:
            robot.ended = ("fell", float(walking.sensed.time[index]), FALLS[causes[index]])
    down = causes != UPRIGHT
    if down.any() and len(robots) > 1:
        return replace(walking, state=walking.state.replaced(down, start))
    return walking


def _crossing(
    robot: _Robot, sensed: Sensed, index: int, unended: tuple[Outcome, float, str]
) -> Crossing:
    outcome, time, cause = robot.ended or unended
    return Crossing(
        *(outcome, time, cause, sensed.com[index], float(sensed.yaw[index])),
        *(tuple(robot.footsteps), tuple(robot.seconds)),
        None if robot.decision is None else robot.decision.plan,
    )
