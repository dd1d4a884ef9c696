"""What is measured of a walking robot at a contact, and where it shall go."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from jaxleas.footsteps.cost_map import FootCostMap
from jaxleas.footsteps.features import wrapped
from jaxleas.footsteps.records import Footsteps
from jaxleas.types import ControllerIdentity, InputError


@dataclass(frozen=True, eq=False)
class WalkingState:
    """A robot between two footsteps, in the world.

    Attributes:
        com: position of the centre of mass [m].
        yaw: heading of the trunk [rad].
        com_velocity: velocity of the centre of mass [m/s].
        yaw_rate: turning rate of the trunk [rad/s].
        feet: positions of the feet [m].
        pair: index of the pair that swings next. It comes from measured contacts: places of feet
            tell it wrongly in 4 to 16 % of footsteps (measured on the logs of the thesis).
        command: forward and sideways speed [m/s] and turning rate [rad/s] commanded until now.
        earlier: command before that one; None for the same.
    """

    com: Float[np.ndarray, "3"]
    yaw: float
    com_velocity: Float[np.ndarray, "3"]
    yaw_rate: float
    feet: Float[np.ndarray, "E 3"]
    pair: int
    command: Float[np.ndarray, "3"]
    earlier: Float[np.ndarray, "3"] | None = None

    @classmethod
    def before(cls, footsteps: Footsteps, index: int) -> "WalkingState":
        """Return the state in which a recorded footstep began."""
        return cls(
            com=footsteps.com_before[index],
            yaw=float(footsteps.yaw_before[index]),
            com_velocity=footsteps.com_velocity_before[index],
            yaw_rate=float(footsteps.yaw_rate_before[index]),
            feet=footsteps.feet_before[index],
            pair=int(footsteps.pair[index]),
            command=footsteps.previous_command[index],
        )


@dataclass(frozen=True)
class Goal:
    """Where the robot shall be.

    Attributes:
        x: place of its centre of mass [m].
        y: the same [m].
        yaw: its heading [rad].
        distance: distance that counts as there [m].
        angle: difference of the heading that counts as there [rad].
        speed: largest horizontal speed of the centre of mass that counts as there: a robot that is
            to stop needs to be slow [m/s].
    """

    x: float
    y: float
    yaw: float = 0.0
    distance: float = 0.05
    angle: float = float(np.radians(5.0))
    speed: float = float("inf")

    def is_met(
        self,
        com: Float[np.ndarray, "K 2"],
        yaw: Float[np.ndarray, " K"],
        velocity: Float[np.ndarray, "K 2"],
    ) -> Bool[np.ndarray, " K"]:
        """Return whether robots are there.

        Args:
            com: x and y of their centres of mass [m].
            yaw: their headings [rad].
            velocity: their horizontal velocities, in any frame [m/s].
        """
        apart = np.hypot(com[:, 0] - self.x, com[:, 1] - self.y)
        turned_away = np.abs(wrapped(self.yaw - yaw))
        slow = np.hypot(velocity[:, 0], velocity[:, 1]) <= self.speed
        return (apart <= self.distance) & (turned_away <= self.angle) & slow

    def is_met_by(self, state: WalkingState) -> bool:
        """Return whether a measured robot is there."""
        yaw = np.array([state.yaw])
        return bool(self.is_met(state.com[None, :2], yaw, state.com_velocity[None, :2])[0])


def require_start(state: WalkingState, costs: FootCostMap, controller: ControllerIdentity) -> None:
    """Refuse a start with a foot where there is no ground, or on an unsafe cell.

    While walking nothing of this is asked: a foot that missed must go on from where it is.

    Raises:
        InputError: the message names the foot, the cell, and the nearest safe one.
    """
    heights = costs.height_map.height_at(state.feet[:, :2])
    for name, foot, height in zip(controller.feet, state.feet, heights, strict=True):
        x, y = foot[:2]
        nearest = costs.nearest_safe(foot[:2])
        there = f"the nearest safe cell is ({nearest[0]:.2f}, {nearest[1]:.2f})"
        if np.isnan(height):
            raise InputError(
                f"the map has no ground under foot {name} at ({x:.2f}, {y:.2f}) m: {there}"
            )
        distance = distance_at(costs, foot[:2])
        if distance <= costs.buffer:
            raise InputError(
                f"foot {name} starts on an unsafe cell at ({x:.2f}, {y:.2f}) m,"
                f" {100 * distance:.1f} cm from an edge where {100 * costs.buffer:.1f} cm are"
                f" needed: {there}"
            )


def require_goal(goal: Goal, costs: FootCostMap) -> None:
    """Refuse a goal outside the map.

    Raises:
        InputError: the message has the extent of the map.
    """
    x_min, x_max, y_min, y_max = costs.height_map.extent
    if not (x_min <= goal.x <= x_max and y_min <= goal.y <= y_max and np.isfinite(goal.yaw)):
        raise InputError(
            f"the goal ({goal.x:g}, {goal.y:g}) is outside the map, which has x from {x_min:g} to"
            f" {x_max:g} m and y from {y_min:g} to {y_max:g} m"
        )


FOOTING = 0.25
"""Distance from a goal within which a foot must be able to stand [m]: a robot's feet are wider
apart, and a goal is where its centre of mass comes to rest."""


def require_footing(goal: Goal, costs: FootCostMap) -> None:
    """Refuse a goal that is over no ground on which a foot may stand.

    Raises:
        InputError: the message has the nearest safe cell.
    """
    nearest = costs.nearest_safe(np.array([goal.x, goal.y]))
    away = float(np.hypot(goal.x - nearest[0], goal.y - nearest[1]))
    if not away <= FOOTING:
        raise InputError(
            f"the goal ({goal.x:g}, {goal.y:g}) is {away:.2f} m away from where a foot may stand:"
            f" the nearest safe cell is ({nearest[0]:.2f}, {nearest[1]:.2f})"
        )


def distance_at(costs: FootCostMap, point: Float[np.ndarray, "2"]) -> float:
    """Return the distance from unsafe cells of the cell around a point [m]; 0 outside the map."""
    cells = np.floor(
        (point - np.array(costs.height_map.origin)) / costs.height_map.resolution + 0.5
    )
    column, row = cells.astype(int)
    rows, columns = costs.distance.shape
    inside = 0 <= row < rows and 0 <= column < columns
    return float(costs.distance[row, column]) if inside else 0.0
