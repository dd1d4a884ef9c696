"""A controller that follows support phases: the centre of mass, the heading, and every swing."""

from dataclasses import asdict, dataclass

import numpy as np
from jaxtyping import Bool, Float, Int

from jaxleas.controllers.controller import JointCommand
from jaxleas.controllers.high_swing import ARRIVES, high_swing
from jaxleas.controllers.legs import LegKinematics
from jaxleas.controllers.phase_tracks import PhaseTracks, Reference
from jaxleas.controllers.swing import FootTarget
from jaxleas.controllers.tracker_forces import TrackerForces
from jaxleas.controllers.tracker_settings import TrackerSettings
from jaxleas.controllers.trot import PERIOD, TOUCHES
from jaxleas.controllers.trot_motion import TrotMotion, motion_of, torques_of
from jaxleas.geometry import distance_inside
from jaxleas.physics import Body, BodyState, Sensed
from jaxleas.types import ControllerIdentity

EARLY = ARRIVES
"""Share of a swing from which on a touch ends it."""
LOST = 0.06
"""Time without ground after which a standing foot is one in the air [s]."""
HURRY = 8.0
"""How fast the pace of a plan's time changes [1/s]."""


@dataclass(frozen=True, eq=False)
class TrackerMemory:
    """What a tracker remembers of N robots.

    Attributes:
        time: time of the plan [s].
        pace: how fast it passes, 0 to 1.
        waited: how long the plan has waited [s].
        aloft: whether a foot is in the air.
        swing: number of the support in which a foot's last swing began.
        lift_off: where each foot left the ground [m].
        unfelt: how long a foot has not touched the ground [s].
    """

    time: Float[np.ndarray, " N"]
    pace: Float[np.ndarray, " N"]
    waited: Float[np.ndarray, " N"]
    aloft: Bool[np.ndarray, "N E"]
    swing: Int[np.ndarray, "N E"]
    lift_off: Float[np.ndarray, "N E 3"]
    unfelt: Float[np.ndarray, "N E"]


class PhaseTracker:
    """Follows the plans of N robots with four legs; it needs no command and reads none.

    Attributes:
        identity: what it is.
        period: time between two decisions [s].
        tracks: what it follows.
        settings: how it does so.
    """

    period = PERIOD

    def __init__(
        self, body: Body, tracks: PhaseTracks, settings: TrackerSettings | None = None
    ) -> None:
        self.tracks, self.settings = tracks, settings or TrackerSettings()
        self._legs = LegKinematics(body)
        self._forces = TrackerForces(body, self.settings)
        self.identity = ControllerIdentity(
            name="tracker",
            robot=body.name,
            feet=body.feet,
            pairs=tuple((foot,) for foot in range(len(body.feet))),
            swing_height=self.settings.clearance,
            foot_radius=body.foot_radius,
            max_speeds=(0.0, 0.0, 0.0),
            settings=asdict(self.settings),
        )

    def start(self, state: BodyState) -> TrackerMemory:
        """Return the memory of robots that stand at rest on the feet of their first phase."""
        feet, count = motion_of(self._legs, state).feet, len(state)
        none = np.zeros(feet.shape[:2])
        return TrackerMemory(
            np.full(count, -self.settings.settles),
            *(np.ones(count), np.zeros(count), none.astype(bool), none.astype(int) - 1),
            *(feet, none),
        )

    def act(
        self,
        memory: TrackerMemory,
        state: BodyState,
        sensed: Sensed,
        command: Float[np.ndarray, "N 3"],
    ) -> tuple[TrackerMemory, JointCommand]:
        """Return the next memory, and the torques until the next decision."""
        del command
        motion, reference = motion_of(self._legs, state), self.tracks.at(memory.time)
        touching = sensed.forces > TOUCHES
        progress, lasts = self._progress(memory, reference)
        swing = self._of(self.tracks.swings.first, reference)
        leaves = (progress > 0.0) & ~memory.aloft & (swing != memory.swing) & (swing >= 0)
        patient = memory.waited < self.settings.waits
        inside = self._inside(motion, sensed, memory.aloft | leaves)
        unsteady = leaves.any(axis=1) & (inside < self.settings.inside)
        leaves &= ~(unsteady & patient)[:, None]
        lands = memory.aloft & touching & (reference.stands | (progress > EARLY))
        unfelt = np.where(touching, 0.0, memory.unfelt + PERIOD)
        aloft = (memory.aloft & ~lands) | leaves | (reference.stands & (unfelt > LOST))
        lift_off = np.where(leaves[..., None], motion.feet, memory.lift_off)
        hindered = unsteady | (aloft & reference.stands).any(axis=1)
        target = high_swing(
            *(lift_off, self._touchdown(reference), self._of(self.tracks.swings.top, reference)),
            *(progress, lasts),
        )
        lowered = aloft & (reference.stands | (progress >= 1.0))
        asked = _at_pace(reference, memory)
        forces = self._forces.carrying(motion, state, sensed, asked, ~aloft)
        pull = self._forces.pull(motion, _slowed(target, memory.pace), lowered)
        forces = np.where(aloft[..., None], pull, self._forces.weight - forces)
        change = np.where(hindered & patient, 0.0, 1.0) - memory.pace
        pace = memory.pace + change.clip(-HURRY * PERIOD, HURRY * PERIOD)
        remembered = TrackerMemory(
            memory.time + pace * PERIOD,
            *(pace, np.where(hindered, memory.waited + PERIOD, 0.0), aloft),
            *(np.where(leaves, swing, memory.swing), lift_off, unfelt),
        )
        return remembered, JointCommand(torques_of(motion, forces), state.angles)

    def _of(self, values: np.ndarray, reference: Reference) -> np.ndarray:
        """Return the values of each robot's support."""
        return values[np.arange(len(self.tracks)), reference.support]

    def _progress(
        self, memory: TrackerMemory, reference: Reference
    ) -> tuple[Float[np.ndarray, "N E"], Float[np.ndarray, "N E"]]:
        """Return how much of each swing is done, and how long it lasts [s]; 1 and 1 s for none."""
        swings = self.tracks.swings
        begin, end = self._of(swings.begin, reference), self._of(swings.end, reference)
        tenth = 0.1 * (end - begin)
        begin = begin + np.minimum(tenth, self.settings.lifts_late)
        end = end - np.minimum(tenth, self.settings.lands_early)
        lasts = np.where(reference.stands, 1.0, end - begin)
        done = ((memory.time[:, None] - begin) / lasts).clip(0.0, 1.0)
        return np.where(reference.stands, 1.0, done), lasts

    def _touchdown(self, reference: Reference) -> Float[np.ndarray, "N E 3"]:
        """Return where feet in the air are to touch down: those that are late, at their places."""
        now = self._of(self.tracks.feet, reference)
        then = self._of(self.tracks.swings.touchdown, reference)
        return np.where(reference.stands[..., None], now, then)

    def _inside(
        self, motion: TrotMotion, sensed: Sensed, aloft: Bool[np.ndarray, "N E"]
    ) -> Float[np.ndarray, " N"]:
        """Return how far the centre of mass is inside the feet that stand [m]."""
        return distance_inside(sensed.com[:, :2], motion.feet[..., :2], ~aloft)


def _at_pace(reference: Reference, memory: TrackerMemory) -> Reference:
    """Return what is asked of robots whose plans' time passes more slowly."""
    pace = memory.pace
    return reference._replace(
        velocity=pace[:, None] * reference.velocity,
        acceleration=(pace * pace)[:, None] * reference.acceleration,
        yaw_rate=pace * reference.yaw_rate,
    )


def _slowed(target: FootTarget, pace: Float[np.ndarray, " N"]) -> FootTarget:
    """Return what is asked of feet of robots whose plans' time passes more slowly."""
    slow = pace[:, None, None]
    return FootTarget(target.place, slow * target.velocity, slow * slow * target.acceleration)
