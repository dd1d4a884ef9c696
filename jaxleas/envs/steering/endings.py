"""What ends an episode of steering: conditions on local terrain and motion, and a foresight."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import Any

import jax.numpy as jnp
import numpy as np
from jax import Array
from jaxtyping import Float, Int

from jaxleas.conditions import (
    Condition,
    EndingConditions,
    Foresight,
    MarginFunction,
    Pick,
    all_of,
    extended,
    make_conditions,
    read_from,
    with_points,
)
from jaxleas.envs.steering.config import SteeringConfig
from jaxleas.envs.steering.spare import points_with_spare, with_larger_trunk
from jaxleas.envs.steering.state import SteeringState
from jaxleas.robots import Robot
from jaxleas.terrain import Atlas
from jaxleas.types import RootMotion

Points = Float[np.ndarray, "points 2"]


@dataclass(frozen=True)
class Given:
    """What ends an episode in place of what the configuration names.

    Attributes:
        condition: condition in place of all those named; a plain callable reads the heights at the
            grid and the footprint.
        foresight: condition with a memory of the episode in place of the one named.
        allow: user's own code that may be run, as MODULE:CLASS; that of `config.conditions`.
    """

    condition: Condition | MarginFunction | None = None
    foresight: Foresight | None = None
    allow: Collection[str] = ()


class Endings:
    """The conditions under which an episode goes on; holds constants only.

    Attributes:
        points_in_root: points at which the local terrain is sampled: those of the observation and
            of the footprint first, then any others that a condition reads [m].
        points_read: points that `condition` reads, a few of those [m].
        condition: condition on local terrain and motion; an episode ends where it fails.
        conditions: conditions that together are `condition`, by name.
        foresight: condition with memory, such as a surrogate of a contact planner; an episode also
            ends where it fails. None: there is no such condition.
    """

    def __init__(
        self,
        config: SteeringConfig,
        robot: Robot,
        sampled: Points,
        given: Given | None = None,
        spare: float = 0.0,
    ) -> None:
        """Prepare the conditions.

        Args:
            config: configuration of the task.
            robot: robot that walks.
            sampled: points whose heights are sampled anyway, in the root frame [m].
            given: conditions in place of those that the configuration names.
            spare: room that a valid configuration leaves (`TerrainConfig.spare`) [m].

        Raises:
            InputError: a condition that the configuration names cannot be made.
        """
        given = given or Given()
        self._config, self._robot, self._sampled, self._given = config, robot, sampled, given
        condition, self.foresight = given.condition, given.foresight
        named: Mapping[str, Condition | MarginFunction] = {}
        if condition is None:
            made = self._named(robot, sampled)
            condition, named = made.condition, made.named
            self.foresight = given.foresight or made.foresight
            if spare:
                condition = self._hardened(condition, spare)
        else:
            named = {"own": condition}
        self._judge = with_points(condition, sampled)
        self.points_read = np.asarray(self._judge.points_in_root, np.float64)
        self.points_in_root = extended(sampled, self.points_read)
        self.condition = read_from(self.points_in_root, self._judge)
        self.conditions = {
            name: read_from(self.points_in_root, with_points(each, sampled))
            for name, each in named.items()
        }

    def _named(self, robot: Robot, points: Points) -> EndingConditions:
        """Return the conditions that the configuration names, for a robot and points."""
        config = self._config
        return make_conditions(config.conditions, robot, points, config, self._given.allow)

    def _hardened(self, condition: Condition, spare: float) -> Condition:
        """Return a condition that holds where the named ones hold, also with less room."""
        larger, sampled = with_larger_trunk(self._robot, spare), self._sampled
        points = points_with_spare(sampled, larger, self._config.outline_spacing, spare)
        return all_of(condition, self._named(larger, points).condition, order=sampled)

    def at(self, points: Points) -> Condition:
        """Return the condition for other points whose heights are sampled anyway.

        It has no spare, and no foresight: that follows an episode, and has no margin at places not
        walked to.

        Args:
            points: points in the root frame [m].
        """
        if self._given.condition is not None:
            return with_points(self._given.condition, self._sampled)
        return self._named(self._robot, points).condition

    def margin(
        self, atlas: Atlas, map_index: Int[Array, "*batch"], motion: RootMotion
    ) -> Float[Array, "*batch"]:
        """Return the margin of the conditions that need no memory [m]."""
        # Computed in the pass over the heights: outside it, each use of the margin would repeat it.
        return atlas.heights_around(
            map_index,
            motion.position,
            motion.yaw,
            self.points_read,
            lambda heights: self._judge(heights, motion),
        )

    def follow(
        self, atlas: Atlas, state: SteeringState, motion: RootMotion
    ) -> tuple[Float[Array, "*batch"], Any]:
        """Return the margin of all conditions [m], and the foresight's memory.

        Args:
            atlas: height maps of the terrains.
            state: state of the episode before the step.
            motion: motion after the step.
        """
        where = state.plan.map_index, motion.position, motion.yaw
        margin = self.margin(atlas, state.plan.map_index, motion)
        if self.foresight is None:
            return margin, state.memory

        def look_around(pick: Pick, points: np.ndarray) -> Array:
            map_index, position, yaw = map(pick, where)
            return atlas.heights_around(map_index, position, yaw, self.points_in_root[points])

        foreseen, memory = self.foresight.follow(state.memory, look_around, motion)
        return jnp.minimum(margin, foreseen), memory
