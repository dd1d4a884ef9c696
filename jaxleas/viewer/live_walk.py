"""A quadruped that walks in physics, in a thread of its own, wherever it is sent.

The page owns the clock: it lets the thread walk for as long as a frame shows, so that neither a
slow browser nor a slow planner changes what happens, only when.
"""

import threading
from dataclasses import dataclass
from queue import Empty, SimpleQueue
from typing import Literal

import numpy as np
from jaxtyping import Float

from jaxleas.controllers import TICK, Ticked, Walk
from jaxleas.crossing import Outcome, cross
from jaxleas.footsteps import Goal, Planner
from jaxleas.physics import BodyState
from jaxleas.types import JaxleasError
from jaxleas.viewer.steered import SteeredCommander

LiveState = Literal["waiting", "walking", "arrived", "no path", "fell", "failed"]
_STATES: dict[Outcome, LiveState] = {
    "reached": "arrived",
    "no path": "no path",
    "fell": "fell",
    "time": "waiting",
    "interrupted": "waiting",
}
LONGEST = 3600.0
"""Time after which a walk to one goal ends [s]."""
BEHIND = 0.25
"""Time by which the walk may be behind the page before it is no longer made up for [s]."""


@dataclass(frozen=True, eq=False)
class Snapshot:
    """The robot at one instant.

    Attributes:
        state: whether it walks, and if not, why.
        coordinates: position and quaternion of the root, and angles of the joints.
        feet: positions of the feet [m].
        seconds: time walked since the start [s].
        why: why there is no path, or why it failed; "" otherwise.
    """

    state: LiveState
    coordinates: Float[np.ndarray, " 7+J"]
    feet: Float[np.ndarray, "E 3"]
    seconds: float
    why: str = ""


class _LeftError(Exception):
    """The walk is left for another wish."""


class LiveWalk:
    """A robot that walks in a thread; see the module.

    Args:
        walk: controller in physics, of one robot.
        start: robot that stands at the start.
        planner: planner on the robot's map.
    """

    def __init__(self, walk: Walk, start: BodyState, planner: Planner) -> None:
        self._walk, self._start, self._planner = walk, start, planner
        self._wishes: SimpleQueue[Goal | Literal["stop", "reset", "close"]] = SimpleQueue()
        self._clock = threading.Condition()
        self._allowed = self._walked = 0.0
        self._pending = 0
        self._stand(start, "waiting")
        self._thread = threading.Thread(target=self._run, name="quadruped", daemon=True)
        self._thread.start()

    def send(self, goal: Goal) -> None:
        """Walk to a goal from now on; a robot that fell lies until it is reset."""
        self._wish(goal)

    def stop(self) -> None:
        """Stand still from now on."""
        self._wish("stop")

    def reset(self) -> None:
        """Stand at the start."""
        self._wish("reset")

    def close(self) -> None:
        """End the thread."""
        self._wish("close")
        self._thread.join()

    @property
    def snapshot(self) -> Snapshot:
        """The robot as it is now."""
        return self._snapshot

    @property
    def busy(self) -> bool:
        """Whether it walks, or has a wish that it has not yet heard."""
        return bool(self._pending) or self._snapshot.state == "walking"

    def advance(self, seconds: float, waits: bool = False) -> None:
        """Let the robot walk on.

        Args:
            seconds: time that it may walk for [s].
            waits: whether to wait until it has.
        """
        with self._clock:
            self._allowed = min(self._allowed + seconds, self._walked + max(seconds, BEHIND))
            self._clock.notify_all()
            if waits:
                self._clock.wait_for(lambda: not self.busy or self._walked >= self._allowed)

    def _wish(self, wish: "Goal | Literal['stop', 'reset', 'close']") -> None:
        with self._clock:
            self._pending += 1
            self._wishes.put(wish)
            self._clock.notify_all()

    def _run(self) -> None:
        while True:
            wish = self._wishes.get()
            if wish == "close":
                return
            if wish == "reset":
                self._stand(self._start, "waiting")
            elif isinstance(wish, Goal) and self._snapshot.state != "fell":
                self._go(wish)
                continue
            self._heard()

    def _go(self, goal: Goal) -> None:
        """Walk until the robot stands at a goal, or something else is wished."""
        self._commander = SteeredCommander(self._planner, goal)
        self._show("walking")
        self._heard()
        try:
            (crossing,) = cross(self._walk, self._now, [self._commander], LONGEST, self._observe)
        except _LeftError:
            return
        except JaxleasError as error:
            self._show("failed", str(error))
            return
        plan = crossing.last_plan
        is_lost = crossing.outcome == "no path" and plan is not None
        self._show(_STATES[crossing.outcome], plan.in_words() if is_lost and plan else "")

    def _observe(self, ticked: Ticked, command: Float[np.ndarray, "1 3"]) -> None:
        """Show a tick, hear what is wished, and wait for the page."""
        del command
        walking = ticked.walking
        self._now, self._feet = walking.state, walking.sensed.feet[0]
        with self._clock:
            self._walked += TICK
            self._show("walking")
            self._clock.notify_all()
            self._clock.wait_for(lambda: self._pending or self._allowed >= self._walked)
        self._listen()

    def _listen(self) -> None:
        """Heed what is wished while the robot walks."""
        try:
            wish = self._wishes.get_nowait()
        except Empty:
            return
        if wish in ("reset", "close"):
            self._wishes.put(wish)  # for `_run`
            raise _LeftError
        self._commander.aim(wish if isinstance(wish, Goal) else None)
        self._heard()

    def _heard(self) -> None:
        with self._clock:
            self._pending -= 1
            self._clock.notify_all()

    def _stand(self, state: BodyState, name: LiveState) -> None:
        """Put the robot somewhere, where it stands."""
        self._now, self._walked, self._allowed = state, 0.0, 0.0
        self._feet = self._walk.begin(state).sensed.feet[0]
        self._show(name)

    def _show(self, name: LiveState, why: str = "") -> None:
        coordinates = self._now.coordinates[0]
        with self._clock:
            self._snapshot = Snapshot(name, coordinates, self._feet, self._walked, why)
            self._clock.notify_all()
