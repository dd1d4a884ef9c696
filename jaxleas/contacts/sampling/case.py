"""What contacts are planned for: a robot in scenes, with its data base and the settings."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from jaxleas.contacts.sampling.database import LegDatabases, leg_databases
from jaxleas.contacts.sampling.ground import Ground, ground_of
from jaxleas.contacts.sampling.settings import SamplingSettings
from jaxleas.contacts.sampling.stance import Stances
from jaxleas.dynamics import ContactPoints, decide_robustness, robustness_of
from jaxleas.robots import Legs, Robot, legs_of
from jaxleas.terrain import Scene


@dataclass(frozen=True, eq=False)
class PlanningCase:
    """Robot, data base, scenes and settings.

    Attributes:
        robot: robot, with its trunk boxes.
        legs: kinematics, soles and masses of the legs.
        databases: leg configurations.
        ground: polygons of the scenes.
        settings: settings of the planner.
    """

    robot: Robot
    legs: Legs
    databases: LegDatabases
    ground: Ground
    settings: SamplingSettings

    def robustness(
        self, stances: Stances, com: Float[np.ndarray, "N 3"]
    ) -> Float[np.ndarray, " N"]:
        """Return the robustness of equilibrium of each posture [N]."""
        return robustness_of(self._contact_points(stances), com, mass=self.legs.mass)

    def is_robust(self, stances: Stances, com: Float[np.ndarray, "N 3"]) -> Bool[np.ndarray, " N"]:
        """Return which postures have the robustness that the settings require."""
        least = self.settings.least_robustness
        robust, missing = decide_robustness(
            self._contact_points(stances), com, mass=self.legs.mass, least=least
        )
        open_ = np.flatnonzero(~(robust | missing))
        if len(open_):
            robust[open_] = self.robustness(stances[open_], com[open_]) >= least
        return robust

    def _contact_points(self, stances: Stances) -> ContactPoints:
        own = np.flatnonzero(self.legs.has_corner)
        foot = own // stances.corners.shape[2]
        return ContactPoints(
            stances.corners.reshape(len(stances), -1, 3)[:, own],
            stances.rotation[..., 2][:, foot],
            self.legs.friction[foot],
            stances.rotation[..., 0][:, foot],
            self.settings.friction_generators,
        )


def make_case(robot: Robot, scenes: Sequence[Scene], settings: SamplingSettings) -> PlanningCase:
    """Return a robot in scenes.

    Args:
        robot: robot whose file describes its legs.
        scenes: terrains.
        settings: settings of the planner.

    Raises:
        InputError: the robot's file does not describe its legs, or it cannot stand on the others
            while it moves one of them.
    """
    return PlanningCase(
        robot,
        legs_of(robot),
        leg_databases(robot, settings.samples, settings.seed),
        ground_of(scenes),
        settings,
    )
