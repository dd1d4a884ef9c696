"""A robot that stands on a terrain of one's own, ready to be planned for."""

from dataclasses import replace

import numpy as np
from jaxtyping import Float

from jaxleas.envs.gait_planning import (
    FEET,
    GaitPlanningConfig,
    Phases,
    PlanningState,
    foot_slacks,
    footholds_are_safe,
    ground_of,
    lowest_foothold,
    rotate,
    trunk_is_free,
)
from jaxleas.gaits.gait import Gait
from jaxleas.gaits.wished_footholds import Footing, footing_of
from jaxleas.geometry import distance_inside
from jaxleas.terrain import HeightMap
from jaxleas.types import InputError, is_ground

COARSEST = 0.04
"""Largest cell on which footholds can be told from edges [m]: a foot's diameter."""
SPREAD = (0.12, 0.09)
"""Largest offset of a foot from its nominal place at the start, ahead and aside [m]."""
FINE = 0.02


class OnTerrain:
    """A terrain, in whose frame plans are made, and the task's frame, which begins at its corner.

    Args:
        config: configuration of the task.
        terrain: height map.

    Raises:
        InputError: the cells are too coarse.
    """

    def __init__(self, config: GaitPlanningConfig, terrain: HeightMap) -> None:
        if terrain.resolution > COARSEST + 1e-9:
            raise InputError(
                f"the terrain has cells of {100 * terrain.resolution:g} cm: a foothold needs cells"
                f" of at most {100 * COARSEST:g} cm; give a finer map, or polygons"
            )
        self.config, self.terrain = config, terrain
        ground = ground_of(config, [terrain], np.zeros(1, np.int64))
        self.footing: Footing = footing_of(config, ground)
        x_min, _, y_min, _ = terrain.extent
        self._corner = np.array([x_min, y_min])

    def stand(self, start: tuple[float, float, float], goal: tuple[float, float]) -> PlanningState:
        """Return one robot at rest on four feet, each at the safe place nearest to its nominal one.

        Args:
            start: x, y of the centre of mass [m] and heading [rad], in the terrain's frame.
            goal: x and y of the goal [m].

        Raises:
            InputError: a foot finds no safe place, the robot is not in equilibrium there, or the
                goal has no ground.
        """
        ground, field = self.footing.ground, np.zeros(1, np.int32)
        com, yaw = (np.array(start[:2]) - self._corner)[None], np.array([start[2]])
        aim = (np.array(goal) - self._corner)[None]
        self._require_goal(goal, aim)
        feet = self._feet(com, yaw, start)
        height = lowest_foothold(feet, field) + self.config.robot.com_height
        phase = Phases(
            com=np.concatenate([com, height[:, None]], axis=1).astype(np.float32),
            yaw=yaw.astype(np.float32),
            velocity=np.zeros((1, 2), np.float32),
            feet=feet.astype(np.float32),
            support=field,
        )
        self._require_standing(phase, start)
        if not trunk_is_free(self.config.robot, ground, field, phase)[0]:
            raise InputError(f"the start {_point(start)}: the terrain reaches the trunk")
        if not footholds_are_safe(ground, field, phase)[0]:
            raise InputError(f"the start {_point(start)}: a foot stands too near an edge")
        once = np.ones((1, len(FEET)), np.int32)
        return PlanningState(phase, field, aim.astype(np.float32), once, field.copy())

    def in_its_frame(self, gait: Gait) -> Gait:
        """Return a way with its places in the terrain's frame."""
        states = gait.states
        shift = np.append(self._corner, 0.0).astype(np.float32)
        phase = states.phase
        moved = replace(phase, com=phase.com + shift, feet=phase.feet + shift)
        goal = states.goal + shift[:2]
        return replace(gait, states=replace(states, phase=moved, goal=goal))

    def _feet(
        self, com: np.ndarray, yaw: np.ndarray, start: tuple[float, float, float]
    ) -> Float[np.ndarray, "1 4 3"]:
        ground, clearance = self.footing.ground, self.config.foot_clearance
        axes = (np.arange(-most, most + 1e-9, FINE) for most in SPREAD)
        offsets = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 2)
        offsets = offsets[np.argsort(np.hypot(*offsets.T), kind="stable")]
        nominal = self.config.robot.nominal[:, None, :2] + offsets
        places = com[:, None, None] + rotate(yaw, nominal[None])
        distance = ground.looked_up(self.footing.distance, np.zeros((1, 1, 1), int), places)
        safe = distance >= clearance
        for foot, name in enumerate(FEET):
            if not safe[0, foot].any():
                most = 100.0 * distance[0, foot].max()
                raise InputError(
                    f"the start {_point(start)}: foot {name} finds no safe place within"
                    f" {100 * SPREAD[0]:g} cm of its own: it would stand {most:.1f} cm from an edge"
                    f" at best, and needs {100 * clearance:g} cm"
                )
        first = safe.argmax(axis=2)[..., None, None]
        chosen = np.take_along_axis(places, first, axis=2)[:, :, 0]
        heights = ground.heights_at(np.zeros((1, 1), int), chosen)
        return np.concatenate([chosen, heights[..., None]], axis=-1)

    def _require_standing(self, phase: Phases, start: tuple[float, float, float]) -> None:
        slack = foot_slacks(self.config.robot, phase)[0]
        foot = int(slack.argmin())
        if slack[foot] <= 0.0:
            raise InputError(
                f"the start {_point(start)}: foot {FEET[foot]} is out of reach by"
                f" {-100 * slack[foot]:.1f} cm: start where the ground under the feet differs less"
                " in height"
            )
        standing = np.ones((1, len(FEET)), bool)
        inside = distance_inside(phase.com[:, :2], phase.feet[..., :2], standing)[0]
        if inside <= 0.0:
            raise InputError(
                f"the start {_point(start)}: the centre of mass is {-100 * inside:.1f} cm outside"
                " the feet"
            )

    def _require_goal(self, goal: tuple[float, float], aim: np.ndarray) -> None:
        x_min, x_max, y_min, y_max = self.terrain.extent
        if not (x_min <= goal[0] <= x_max and y_min <= goal[1] <= y_max):
            raise InputError(
                f"the goal ({goal[0]:g}, {goal[1]:g}) is outside the terrain: x from {x_min:g} to"
                f" {x_max:g}, y from {y_min:g} to {y_max:g} m"
            )
        height = self.footing.ground.heights_at(np.zeros(1, int), aim)[0]
        if not is_ground(height):
            raise InputError(
                f"the goal ({goal[0]:g}, {goal[1]:g}) is on nothing: no ground is there"
            )


def _point(start: tuple[float, float, float]) -> str:
    return f"({start[0]:g}, {start[1]:g})"
