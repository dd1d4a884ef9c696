"""Forces of a phase tracker: of the ground on standing feet, and of the legs on feet in the air."""

import numpy as np
from jaxtyping import Bool, Float

from jaxleas.controllers.cone_forces import cone_forces
from jaxleas.controllers.phase_tracks import Reference
from jaxleas.controllers.swing import FootTarget
from jaxleas.controllers.tracker_settings import TrackerSettings
from jaxleas.controllers.trot_motion import TrotMotion
from jaxleas.geometry import wrap_angle_on_host
from jaxleas.physics import Body, BodyState, Sensed

GRAVITY = 9.81
MOST_PULL = 5.0
"""Largest acceleration that is asked for along each axis, gravity apart [m/s2]."""
SINKING = 0.2
"""Speed at which a foot is lowered that is not yet down when it should stand [m/s]."""


class TrackerForces:
    """What a tracker wants of feet that stand and of feet in the air.

    Attributes:
        weight: force at each foot that carries its leg, whether it stands or not [N].

    Args:
        body: robot.
        settings: how a plan is followed.
    """

    def __init__(self, body: Body, settings: TrackerSettings) -> None:
        self._body, self._settings = body, settings
        self.weight = settings.swing_mass * np.array([0.0, 0.0, GRAVITY])

    def carrying(
        self,
        motion: TrotMotion,
        state: BodyState,
        sensed: Sensed,
        reference: Reference,
        stands: Bool[np.ndarray, "N E"],
    ) -> Float[np.ndarray, "N E 3"]:
        """Return the ground's forces on standing feet that bring the trunk to its place [N]."""
        settings, body = self._settings, self._body
        pull = settings.place * (reference.com - sensed.com)
        pull += settings.speed * (reference.velocity - sensed.com_velocity)
        pull = (pull + reference.acceleration).clip(-MOST_PULL, MOST_PULL)
        pull[:, 2] += GRAVITY
        in_level = np.swapaxes(motion.level, 1, 2)
        # The root's vertical axis, seen from the heading: its tilt is roll and pitch.
        axis = (in_level @ motion.rotation[:, :, 2:])[..., 0]
        rate = (in_level @ motion.rotation @ state.turning_rate[..., None])[..., 0]
        turn = -settings.tilt_rate * rate
        turn[:, 0] += settings.tilt * axis[:, 1]
        turn[:, 1] -= settings.tilt * axis[:, 0]
        turn[:, 2] += settings.tilt * wrap_angle_on_host(reference.yaw - motion.yaw)
        turn[:, 2] += settings.tilt_rate * reference.yaw_rate
        force = (in_level @ (body.mass * pull)[..., None])[..., 0]
        wrench = np.concatenate([force, body.inertia * turn], axis=1)
        arms = (motion.feet - sensed.com[:, None]) @ motion.level
        forces = cone_forces(wrench, arms, stands, settings.friction, settings.least_force)
        return forces @ in_level

    def pull(
        self, motion: TrotMotion, target: FootTarget, lowered: Bool[np.ndarray, "N E"]
    ) -> Float[np.ndarray, "N E 3"]:
        """Return the forces with which the legs move feet in the air [N].

        Args:
            motion: motion of the robots.
            target: where the feet are to be.
            lowered: whether a foot is to go down from where it is until it touches.
        """
        settings = self._settings
        error, wanted = target.place - motion.feet, target.velocity.copy()
        error[..., 2] = np.where(lowered, 0.0, error[..., 2])
        wanted[..., 2] = np.where(lowered, -SINKING, wanted[..., 2])
        pull = settings.swing_stiffness * error
        pull += settings.swing_damping * (wanted - motion.foot_velocities)
        pull += settings.swing_mass * np.where(lowered[..., None], 0.0, target.acceleration)
        return pull + self.weight
