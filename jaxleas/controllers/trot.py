"""A model-based trot: a clock, a touchdown rule, least ground forces and a spring on each swing."""

from dataclasses import asdict, dataclass

import numpy as np
from jaxtyping import Bool, Float

from jaxleas.controllers.clock import Schedule, schedule
from jaxleas.controllers.controller import JointCommand
from jaxleas.controllers.ground import GroundPlane
from jaxleas.controllers.legs import LegKinematics, LegPosture, cross
from jaxleas.controllers.stance import ground_forces
from jaxleas.controllers.swing import FootTarget, swing_target
from jaxleas.controllers.trot_settings import GAINS, TROT, TrotGains, TrotSettings
from jaxleas.physics import Body, BodyState, Sensed
from jaxleas.types import ControllerIdentity, matrix_of

GRAVITY = 9.81
PERIOD = 0.004
"""Time between two decisions [s]."""
TOUCHES = 5.0
"""Force from which on a foot is on the ground [N]."""
EARLY = 0.5
"""Share of the swing from which on a touch ends it."""
SINKING = 0.5
"""Speed at which a foot that should stand is lowered until it touches [m/s]."""
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


@dataclass(frozen=True, eq=False)
class _Motion:
    """The robots' motion, as the trot needs it.

    Attributes:
        rotation: orientation of the root.
        posture: feet and Jacobians in the root frame.
        feet: positions of the feet in the world [m].
        foot_velocities: their velocities in the world [m/s].
        yaw: heading [rad].
        level: rotation by the heading alone.
    """

    rotation: Float[np.ndarray, "N 3 3"]
    posture: LegPosture
    feet: Float[np.ndarray, "N E 3"]
    foot_velocities: Float[np.ndarray, "N E 3"]
    yaw: Float[np.ndarray, " N"]
    level: Float[np.ndarray, "N 3 3"]


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
        self._gains = gains
        self._body = body
        self._legs = LegKinematics(body)
        self._nominal = self._legs.posture(body.standing[None]).feet[0] * np.array([1.0, 1.0, 0.0])
        # Feet on one diagonal swing together; the others half a cycle later.
        second = self._nominal[:, 0] * self._nominal[:, 1] < 0.0
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
        feet = self._motion(state).feet
        return TrotMemory(np.zeros(len(state)), feet, feet, np.zeros(feet.shape[:2], dtype=bool))

    def act(
        self,
        memory: TrotMemory,
        state: BodyState,
        sensed: Sensed,
        command: Float[np.ndarray, "N 3"],
    ) -> tuple[TrotMemory, JointCommand]:
        """Return the next memory, and the torques until the next decision."""
        motion = self._motion(state)
        planned = schedule(memory.phase, self._offsets, self.settings.duty)
        touching = sensed.forces > TOUCHES
        swings = planned.swings & ~(touching & (planned.progress > EARLY))
        stands = ~swings & touching
        begins = planned.swings & ~memory.swung
        lift_off = np.where(begins[..., None], motion.feet, memory.lift_off)
        footholds = np.where(stands[..., None], motion.feet, memory.footholds)
        ground = GroundPlane.through(footholds)
        target = self._target(state, motion, planned, lift_off, ground, command)
        forces = self._stance(state, motion, stands, ground, command)
        forces = np.where(stands[..., None], -forces, self._pull(motion, target, swings))
        falling = ~touching & (motion.feet[..., 2] > ground.height_at(motion.feet[..., :2]) - DEEP)
        pace = np.where(planned.all_stand & falling.any(axis=1), WAITING, 1.0)
        pace = np.where(planned.all_stand & self._rests(state, command), 0.0, pace)
        phase = (memory.phase + pace * PERIOD / self.settings.cycle) % 1.0
        remembered = TrotMemory(phase, footholds, lift_off, planned.swings)
        torques = _torques(motion, forces)
        return remembered, JointCommand(torques, state.angles)

    def _motion(self, state: BodyState) -> _Motion:
        rotation = matrix_of(state.quaternion)
        posture = self._legs.posture(state.angles)
        arms = posture.feet @ np.swapaxes(rotation, 1, 2)
        legs = arms.shape[1]
        speeds = state.joint_speeds.reshape(len(state), legs, -1, 1)
        moving = (posture.jacobians @ speeds)[..., 0] @ np.swapaxes(rotation, 1, 2)
        turning = (rotation @ state.turning_rate[..., None])[:, None, :, 0]
        yaw = np.arctan2(rotation[:, 1, 0], rotation[:, 0, 0])
        cosine, sine = np.cos(yaw), np.sin(yaw)
        level = np.zeros_like(rotation)
        level[:, 0, 0] = level[:, 1, 1] = cosine
        level[:, 1, 0], level[:, 0, 1] = sine, -sine
        level[:, 2, 2] = 1.0
        return _Motion(
            rotation,
            posture,
            state.position[:, None] + arms,
            state.velocity[:, None] + cross(turning, arms) + moving,
            yaw,
            level,
        )

    def _target(
        self,
        state: BodyState,
        motion: _Motion,
        planned: Schedule,
        lift_off: np.ndarray,
        ground: GroundPlane,
        command: np.ndarray,
    ) -> FootTarget:
        """Return where swinging feet are to be."""
        settings = self.settings
        left = (1.0 - planned.progress) * settings.swing_time
        velocity = (np.swapaxes(motion.level, 1, 2) @ state.velocity[..., None])[..., 0]
        wanted = np.zeros_like(velocity)
        wanted[:, :2] = command[:, :2]
        gain = self._error_gain
        places = self._nominal + np.zeros((len(state), 1, 1))
        places = places + velocity[:, None] * left[..., None]
        # A foot stands half of its stance ahead of its hip, which also goes round the root.
        turn = command[:, 2, None] * (left + 0.5 * settings.stance_time)
        x, y = self._nominal[:, 0], self._nominal[:, 1]
        places[..., 0] -= turn * y
        places[..., 1] += turn * x
        ahead = 0.5 * settings.stance_time * wanted + gain * (velocity - wanted)
        places = places + ahead[:, None]
        touchdown = places @ np.swapaxes(motion.level, 1, 2)
        touchdown[..., :2] += state.position[:, None, :2]
        touchdown[..., 2] = ground.height_at(touchdown[..., :2])
        return swing_target(
            lift_off, touchdown, planned.progress, settings.swing_time, settings.swing_height
        )

    @property
    def _error_gain(self) -> float:
        if self.settings.touchdown == "capture":
            return float(np.sqrt(self.settings.height / GRAVITY))
        return self.settings.speed_error_gain

    def _pull(self, motion: _Motion, target: FootTarget, swings: np.ndarray) -> np.ndarray:
        """Return the forces with which the legs move feet that do not carry [N]."""
        gains = self._gains
        lowered = np.array([0.0, 0.0, -SINKING])
        error = np.where(swings[..., None], target.place - motion.feet, 0.0)
        wanted = np.where(swings[..., None], target.velocity, lowered)
        pull = gains.swing_stiffness * error
        pull += gains.swing_damping * (wanted - motion.foot_velocities)
        pull += gains.swing_mass * np.where(swings[..., None], target.acceleration, 0.0)
        pull[..., 2] += gains.swing_mass * GRAVITY
        return pull

    def _stance(
        self,
        state: BodyState,
        motion: _Motion,
        stands: np.ndarray,
        ground: GroundPlane,
        command: np.ndarray,
    ) -> np.ndarray:
        """Return the forces of the ground on standing feet [N]."""
        gains, mass = self._gains, self._body.mass
        velocity = (np.swapaxes(motion.level, 1, 2) @ state.velocity[..., None])[..., 0]
        root = state.position[:, None, :2]
        pull = np.empty_like(velocity)
        pull[:, :2] = gains.speed * (command[:, :2] - velocity[:, :2])
        below = ground.height_at(root)[:, 0] + self.settings.height - state.position[:, 2]
        pull[:, 2] = gains.height * below - gains.climb * velocity[:, 2] + GRAVITY
        rotation = motion.rotation
        # The root's vertical axis, seen from the heading: its tilt is roll and pitch.
        axis = (np.swapaxes(motion.level, 1, 2) @ rotation[:, :, 2:])[..., 0]
        slope = -np.arctan((ground.gradient[:, None] @ motion.level[:, :2, :1])[:, 0, 0])
        roll, pitch = -axis[:, 1], axis[:, 0] - slope
        rate = (np.swapaxes(motion.level, 1, 2) @ rotation @ state.turning_rate[..., None])[..., 0]
        turn = np.empty_like(velocity)
        turn[:, 0] = -gains.tilt * roll - gains.tilt_rate * rate[:, 0]
        turn[:, 1] = -gains.tilt * pitch - gains.tilt_rate * rate[:, 1]
        turn[:, 2] = gains.turning * (command[:, 2] - rate[:, 2])
        wrench = np.concatenate([mass * pull, self._body.inertia * turn], axis=1)
        com = state.position + rotation @ self._body.com
        arms = (motion.feet - com[:, None]) @ motion.level
        forces = ground_forces(wrench, arms, stands, self.settings.friction)
        return forces @ np.swapaxes(motion.level, 1, 2)

    def _rests(self, state: BodyState, command: np.ndarray) -> np.ndarray:
        """Return which robots are to stand, and are slow enough to do so."""
        slow = (np.abs(state.velocity) < SLOW).all(axis=1)
        return (command == 0.0).all(axis=1) & slow


def _torques(motion: _Motion, forces: np.ndarray) -> np.ndarray:
    """Return the torques of joints whose feet push with forces, given in the world [Nm]."""
    inside = forces @ motion.rotation
    torques = np.swapaxes(motion.posture.jacobians, -1, -2) @ inside[..., None]
    return torques[..., 0].reshape(len(forces), -1)
