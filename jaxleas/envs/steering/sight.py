"""What a steered robot sees: its motion and goal, the heights of a grid, and what it feels."""

import jax.numpy as jnp
import numpy as np
from jax import Array
from jaxtyping import Float, Int

from jaxleas.conditions import extended, footprint_points, outline_points
from jaxleas.envs.steering.config import SteeringConfig
from jaxleas.envs.steering.feelers import Feelers
from jaxleas.envs.steering.layout import MOTION_SIZE, ObservationLayout, layout_named
from jaxleas.envs.steering.observation import seen_motion, write_observation
from jaxleas.envs.steering.surface_count import surface_count
from jaxleas.robots import Robot
from jaxleas.terrain import Terrains
from jaxleas.types import RootMotion


def sampled_points(config: SteeringConfig, robot: Robot) -> Float[np.ndarray, "points 2"]:
    """Return the points that an environment samples anyway, in the root frame [m].

    They are those of the observation's grid, then the footprint, then those along the outline.

    Args:
        config: configuration of the task.
        robot: robot that walks.
    """
    layout = layout_named(config.observation)
    sampled = np.concatenate([layout.points_in_root, footprint_points(robot)])
    if config.outline_spacing:
        sampled = extended(sampled, outline_points(robot, config.outline_spacing))
    return sampled


class Sight:
    """The observation of one layout; holds constants only.

    Attributes:
        layout: layout of the observation.
        height_range: bounds to which seen heights are clipped, relative to the root [m].
        feelers: feelers of the layout; None: it has none.
    """

    def __init__(
        self,
        layout: ObservationLayout,
        height_range: tuple[float, float],
        feelers: Feelers | None = None,
    ) -> None:
        """Prepare the observation.

        Args:
            layout: layout of the observation.
            height_range: bounds to which seen heights are clipped, relative to the root [m].
            feelers: feelers of the layout, if it has any.
        """
        self.layout, self.height_range, self.feelers = layout, height_range, feelers
        # Places kept for the motion, then the grid: an observation is written in one pass.
        self._points = np.concatenate([np.zeros((MOTION_SIZE, 2)), layout.points_in_root])

    def observe(
        self,
        heights_in_root: Float[Array, "*batch points"],
        motion: RootMotion,
        goal: Float[Array, "*batch 2"],
    ) -> Float[Array, "*batch size"]:
        """Return the observation of a robot on local terrain.

        Args:
            heights_in_root: heights relative to the root [m]: those of the grid first, those of the
                feelers last.
            motion: motion of the root.
            goal: goal that is sought [m].
        """
        seen = heights_in_root[..., : len(self.layout.points_in_root)]
        columns = jnp.pad(seen, [(0, 0)] * (seen.ndim - 1) + [(MOTION_SIZE, 0)])
        observation = self._write(columns, *seen_motion(motion, goal))
        if self.feelers is None:
            return observation
        felt = heights_in_root[..., -len(self.feelers.points_in_root) :]
        return jnp.concatenate([observation, self.feelers(felt, motion)], axis=-1)

    def look(
        self,
        atlas: Terrains,
        map_index: Int[Array, "*batch"],
        motion: RootMotion,
        goal: Float[Array, "*batch 2"],
    ) -> Float[Array, "*batch size"]:
        """Return what `observe` does for a robot on a map, in one pass over the heights."""
        where = map_index, motion.position, motion.yaw
        observation = atlas.heights_around(
            *where, self._points, self._write, *seen_motion(motion, goal)
        )
        if self.feelers is None:
            return observation
        feelers = self.feelers
        felt = atlas.heights_around(
            *where, feelers.points_in_root, lambda heights: feelers(heights, motion)
        )
        return jnp.concatenate([observation, felt], axis=-1)

    def _write(self, columns: Array, *seen: Array) -> Array:
        """Return the observation of heights, after the columns that are kept for the motion."""
        observation = write_observation(columns, *seen, height_range=self.height_range)
        if not self.layout.counts_surfaces:
            return observation
        heights, layout = columns[..., MOTION_SIZE:], self.layout
        count = surface_count(heights, layout.rows, layout.columns, self.height_range)
        return jnp.concatenate([observation, count[..., None]], axis=-1)
