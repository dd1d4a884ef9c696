"""Forces of a trot: on swinging feet, towards where they are to be; on standing feet."""

import numpy as np
from jaxtyping import Float

from jaxleas.controllers.clock import Schedule
from jaxleas.controllers.ground import GroundPlane
from jaxleas.controllers.stance import ground_forces
from jaxleas.controllers.swing import FootTarget, swing_target
from jaxleas.controllers.trot_motion import TrotMotion
from jaxleas.controllers.trot_settings import TrotGains, TrotSettings
from jaxleas.physics import Body, BodyState

GRAVITY = 9.81
SINKING = 0.5
"""Speed at which a foot that should stand is lowered until it touches [m/s]."""


class TrotForces:
    """What a trot wants of swinging and standing feet.

    Args:
        body: robot.
        nominal: places of the feet under the hips, in the robot's frame [m].
        settings: how it walks.
        gains: gains of its feedback.
    """

    def __init__(
        self,
        body: Body,
        nominal: Float[np.ndarray, "E 3"],
        settings: TrotSettings,
        gains: TrotGains,
    ) -> None:
        self._body, self._nominal = body, nominal
        self._settings, self._gains = settings, gains

    def target(
        self,
        state: BodyState,
        motion: TrotMotion,
        planned: Schedule,
        lift_off: np.ndarray,
        ground: GroundPlane,
        command: np.ndarray,
    ) -> FootTarget:
        """Return where swinging feet are to be."""
        settings = self._settings
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
        if self._settings.touchdown == "capture":
            return float(np.sqrt(self._settings.height / GRAVITY))
        return self._settings.speed_error_gain

    def pull(self, motion: TrotMotion, target: FootTarget, swings: np.ndarray) -> np.ndarray:
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

    def stance(
        self,
        state: BodyState,
        motion: TrotMotion,
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
        below = ground.height_at(root)[:, 0] + self._settings.height - state.position[:, 2]
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
        forces = ground_forces(wrench, arms, stands, self._settings.friction)
        return forces @ np.swapaxes(motion.level, 1, 2)
