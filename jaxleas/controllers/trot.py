"""A model-based trot: when feet swing and stand, by a clock and by what they touch."""

from dataclasses import asdict, dataclass

import numpy as np
from jaxtyping import Bool, Float

from jaxleas.controllers.clock import schedule
from jaxleas.controllers.controller import JointCommand
from jaxleas.controllers.ground import GroundPlane
from jaxleas.controllers.legs import LegKinematics
from jaxleas.controllers.trot_forces import TrotForces
from jaxleas.controllers.trot_motion import motion_of, torques_of
from jaxleas.controllers.trot_settings import GAINS, TROT, TrotGains, TrotSettings
from jaxleas.physics import Body, BodyState, Sensed
from jaxleas.types import ControllerIdentity

PERIOD = 0.004
"""Time between two decisions [s]."""
TOUCHES = 5.0
"""Force from which on a foot is on the ground [N]."""
EARLY = 0.5
"""Share of the swing from which on a touch ends it."""
DEEP = 0.12
"""Depth under the ground expected from which on a foot is no longer waited for [m]."""
WAITING = 0.2
"""Pace of the clock while all feet should stand and one still falls."""
SLOW = 0.08
"""Speed below which a robot that is to stand stops stepping [m/s]."""


@dataclass(frozen=True, eq=False)
class TrotMemory:
    """What a trot remembers of N robots.

    Attributes:
        phase: place in the gait cycle, 0 to 1.
        footholds: where each foot stood last, in the world [m].
        lift_off: where each foot left the ground, in the world [m].
        swung: whether each foot swung at the last decision.
    """

    phase: Float[np.ndarray, " N"]
    footholds: Float[np.ndarray, "N E 3"]
    lift_off: Float[np.ndarray, "N E 3"]
    swung: Bool[np.ndarray, "N E"]


class Trot:
    """A trot of a robot with four legs of three joints.

    Attributes:
        identity: what its footsteps and models are those of.
        period: time between two decisions [s].
        settings: how it walks.
    """

    period = PERIOD

    def __init__(
        self,
        name: str,
        body: Body,
        settings: TrotSettings = TROT,
        gains: TrotGains = GAINS,
    ) -> None:
        self.settings = settings
        self._legs = LegKinematics(body)
        nominal = self._legs.posture(body.standing[None]).feet[0] * np.array([1.0, 1.0, 0.0])
        self._forces = TrotForces(body, nominal, settings, gains)
        # Feet on one diagonal swing together; the others half a cycle later.
        second = nominal[:, 0] * nominal[:, 1] < 0.0
        pairs = tuple(tuple(map(int, np.flatnonzero(second == late))) for late in (False, True))
        self._offsets = 0.5 * second
        self.identity = ControllerIdentity(
            name=name,
            robot=body.name,
            feet=body.feet,
            pairs=pairs,
            swing_height=settings.swing_height,
            foot_radius=body.foot_radius,
            max_speeds=settings.max_speeds,
            settings=settings.as_identity()
            | {f"gain_{key}": value for key, value in asdict(gains).items()},
        )

    def start(self, state: BodyState) -> TrotMemory:
        """Return the memory of robots that stand at rest."""
        feet = motion_of(self._legs, state).feet
        return TrotMemory(np.zeros(len(state)), feet, feet, np.zeros(feet.shape[:2], dtype=bool))

    def act(
        self,
        memory: TrotMemory,
        state: BodyState,
        sensed: Sensed,
        command: Float[np.ndarray, "N 3"],
    ) -> tuple[TrotMemory, JointCommand]:
        """Return the next memory, and the torques until the next decision."""
        motion = motion_of(self._legs, state)
        planned = schedule(memory.phase, self._offsets, self.settings.duty)
        touching = sensed.forces > TOUCHES
        swings = planned.swings & ~(touching & (planned.progress > EARLY))
        stands = ~swings & touching
        begins = planned.swings & ~memory.swung
        lift_off = np.where(begins[..., None], motion.feet, memory.lift_off)
        footholds = np.where(stands[..., None], motion.feet, memory.footholds)
        ground = GroundPlane.through(footholds)
        target = self._forces.target(state, motion, planned, lift_off, ground, command)
        forces = self._forces.stance(state, motion, stands, ground, command)
        forces = np.where(stands[..., None], -forces, self._forces.pull(motion, target, swings))
        falling = ~touching & (motion.feet[..., 2] > ground.height_at(motion.feet[..., :2]) - DEEP)
        pace = np.where(planned.all_stand & falling.any(axis=1), WAITING, 1.0)
        pace = np.where(planned.all_stand & self._rests(state, command), 0.0, pace)
        phase = (memory.phase + pace * PERIOD / self.settings.cycle) % 1.0
        remembered = TrotMemory(phase, footholds, lift_off, planned.swings)
        torques = torques_of(motion, forces)
        return remembered, JointCommand(torques, state.angles)

    def _rests(self, state: BodyState, command: np.ndarray) -> np.ndarray:
        """Return which robots are to stand, and are slow enough to do so."""
        slow = (np.abs(state.velocity) < SLOW).all(axis=1)
        return (command == 0.0).all(axis=1) & slow
