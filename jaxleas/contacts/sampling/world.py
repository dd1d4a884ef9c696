"""All that a plan is made in and with: robot, data base, scene, settings."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from jaxleas.contacts.sampling.database import LegDatabase, talos_database
from jaxleas.contacts.sampling.ground import Ground, ground_of
from jaxleas.contacts.sampling.settings import SamplingSettings
from jaxleas.contacts.sampling.stance import Stances
from jaxleas.dynamics.equilibrium import equilibrium_robustness
from jaxleas.robots import Robot, load_talos
from jaxleas.robots.legs import LegModel, load_talos_legs
from jaxleas.terrain.scene import Scene


@dataclass(frozen=True, eq=False)
class World:
    """Robot, data base, scene and settings.

    Attributes:
        robot: trunk boxes, friction, size of the soles.
        legs: their kinematics and masses.
        database: leg configurations.
        ground: the scene's polygons.
        settings: of the planner.
    """

    robot: Robot
    legs: LegModel
    database: LegDatabase
    ground: Ground
    settings: SamplingSettings

    def robustness(
        self, stances: Stances, com: Float[np.ndarray, "N 3"]
    ) -> Float[np.ndarray, " N"]:
        """Return the robustness of equilibrium of each posture [N]."""
        count = len(com)
        normals = np.repeat(stances.rotation[..., 2], 4, axis=1)
        return equilibrium_robustness(
            stances.corners.reshape(count, -1, 3),
            normals,
            com,
            mass=self.legs.mass,
            friction=self.robot.friction,
        )


def talos_world(scene: Scene, settings: SamplingSettings) -> World:
    """Return Talos in a scene."""
    return World(
        load_talos(),
        load_talos_legs(),
        talos_database(settings.samples, settings.seed),
        ground_of(scene),
        settings,
    )
