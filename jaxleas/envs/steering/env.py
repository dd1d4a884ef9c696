"""LEAS steering as pure functions: a robot's root, a terrain, a goal (T ch. 3)."""

from collections.abc import Collection, Mapping
from typing import Any

import jax.numpy as jnp
import numpy as np
from jax import Array
from jaxtyping import Float, Int

from jaxleas.conditions import (
    Condition,
    Foresight,
    MarginFunction,
    Pick,
    all_of,
    extended,
    footprint_points,
    make_conditions,
    outline_points,
    read_from,
    with_points,
)
from jaxleas.envs.steering.config import SteeringConfig
from jaxleas.envs.steering.feelers import Feelers
from jaxleas.envs.steering.layout import ACTION_SIZE, MOTION_SIZE, layout_named
from jaxleas.envs.steering.motion import integrate, scale_action
from jaxleas.envs.steering.observation import direction_to_goal, seen_motion, write_observation
from jaxleas.envs.steering.reward import RewardParams, reward
from jaxleas.envs.steering.spare import points_with_spare, with_larger_trunk
from jaxleas.envs.steering.state import (
    GOALS,
    Route,
    SeenResult,
    SteeringResult,
    SteeringState,
)
from jaxleas.envs.steering.surface_count import surface_count
from jaxleas.robots import load_robot
from jaxleas.terrain import Atlas
from jaxleas.types import RootMotion
from jaxleas.xla import compute_once


class SteeringEnv:
    """The steering task for one configuration; holds constants only, every method is pure.

    The local terrain of a robot is the heights at `points_in_root`: first the observation's grid,
    then the footprint, a finer grid in the trunk's shadow that the conditions need and the policy
    does not see, any other points that the user's own condition reads, and finally those of the
    feelers.

    Attributes:
        config: configuration of the task.
        layout: layout of the observation.
        robot: robot that walks.
        points_in_root: points at which the local terrain is sampled [m].
        condition: condition on local terrain and motion; an episode ends where it fails.
        conditions: conditions that together are `condition`, by name.
        foresight: condition with memory, such as a surrogate of a contact planner; an episode also
            ends where it fails. None: there is no such condition.
        feelers: feelers of the layout; None: it has none.
    """

    action_size = ACTION_SIZE

    def __init__(
        self,
        config: SteeringConfig,
        condition: Condition | MarginFunction | None = None,
        foresight: Foresight | None = None,
        allow: Collection[str] = (),
        spare: float = 0.0,
    ):
        """Prepare the task.

        Args:
            config: configuration of the task.
            condition: condition that ends an episode, in place of all those that the configuration
                names; a plain callable reads the heights at the grid and the footprint.
            foresight: condition with a memory of the episode that also ends it, in place of the
                one that the configuration names.
            allow: user's own code that may be run, as MODULE:CLASS; those of `config.conditions`.
            spare: room that a valid configuration leaves (`TerrainConfig.spare`) [m].

        Raises:
            InputError: a condition that the configuration names cannot be made.
        """
        self.config = config
        self.layout = layout_named(config.observation)
        self.robot = load_robot(config.robot)
        self.height_range = (config.height_low, config.height_high)
        # Points of the observation: places kept for the motion, then its grid.
        self._seen = np.concatenate([np.zeros((MOTION_SIZE, 2)), self.layout.points_in_root])
        sampled = np.concatenate([self.layout.points_in_root, footprint_points(self.robot)])
        if config.outline_spacing:
            sampled = extended(sampled, outline_points(self.robot, config.outline_spacing))
        named: Mapping[str, Condition | MarginFunction] = (
            {} if condition is None else {"own": condition}
        )
        given = condition
        if condition is None:
            made = make_conditions(config.conditions, self.robot, sampled, config, allow)
            condition, foresight = made.condition, foresight or made.foresight
            named = made.named
            if spare:
                condition = self._hardened(made.condition, sampled, spare, allow)
        self.foresight = foresight
        # Points that the conditions read: only a few of all.
        self._judge = with_points(condition, sampled)
        self._judged = np.asarray(self._judge.points_in_root, np.float64)
        self.points_in_root = extended(sampled, self._judged)
        self.condition = read_from(self.points_in_root, self._judge)
        self.conditions = {
            name: read_from(self.points_in_root, with_points(each, sampled))
            for name, each in named.items()
        }
        self.feelers = None
        if self.layout.feelers:

            def make(points: np.ndarray) -> Condition:
                if given is not None:
                    return with_points(given, sampled)
                # A foresight follows an episode: it has no margin at places not walked to.
                return make_conditions(
                    config.conditions, self.robot, points, config, allow
                ).condition

            self.feelers = Feelers(self.robot, self.layout.feelers, make)
            # All of them, also those known already: they are read as one block.
            self.points_in_root = np.concatenate([self.points_in_root, self.feelers.points_in_root])

    def _hardened(
        self, condition: Condition, sampled: np.ndarray, spare: float, allow: Collection[str]
    ) -> Condition:
        """Return a condition that holds where the named ones hold, also with less room."""
        config, larger = self.config, with_larger_trunk(self.robot, spare)
        points = points_with_spare(sampled, larger, config.outline_spacing, spare)
        harder = make_conditions(config.conditions, larger, points, config, allow).condition
        return all_of(condition, harder, order=sampled)

    def local_heights(
        self, atlas: Atlas, map_index: Int[Array, "*batch"], motion: RootMotion
    ) -> Float[Array, "*batch points"]:
        """Return the local terrain: heights at `points_in_root` relative to the root [m]."""
        return atlas.heights_around(map_index, motion.position, motion.yaw, self.points_in_root)

    def observe(
        self,
        heights_in_root: Float[Array, "*batch points"],
        motion: RootMotion,
        goal: Float[Array, "*batch 2"],
    ) -> Float[Array, "*batch size"]:
        """Return the observation of a robot that seeks `goal` on this local terrain."""
        seen = heights_in_root[..., : len(self.layout.points_in_root)]
        columns = jnp.pad(seen, [(0, 0)] * (seen.ndim - 1) + [(MOTION_SIZE, 0)])
        observation = self._write(columns, *seen_motion(motion, goal))
        if self.feelers is None:
            return observation
        first = len(self.points_in_root) - len(self.feelers.points_in_root)
        felt = self.feelers(heights_in_root[..., first:], motion)
        return jnp.concatenate([observation, felt], axis=-1)

    def look(self, atlas: Atlas, state: SteeringState) -> Float[Array, "*batch size"]:
        """Return the robots' observation: as `observe` on their local terrain, in one pass."""
        motion = state.motion
        where = state.plan.map_index, motion.position, motion.yaw
        observation = atlas.heights_around(
            *where, self._seen, self._write, *seen_motion(motion, self.goal(state))
        )
        if self.feelers is None:
            return observation
        feelers = self.feelers
        felt = atlas.heights_around(
            *where, feelers.points_in_root, lambda heights: feelers(heights, motion)
        )
        return jnp.concatenate([observation, felt], axis=-1)

    def margin(
        self, atlas: Atlas, map_index: Int[Array, "*batch"], motion: RootMotion
    ) -> Float[Array, "*batch"]:
        """Return the margin of the conditions that need no memory [m]."""
        # Computed in the pass over the heights: outside it, each use of the margin would repeat it.
        return atlas.heights_around(
            map_index,
            motion.position,
            motion.yaw,
            self._judged,
            lambda heights: self._judge(heights, motion),
        )

    def _write(self, columns: Array, *seen: Array) -> Array:
        """Return the observation of heights, after the columns that are kept for the motion."""
        observation = write_observation(columns, *seen, height_range=self.height_range)
        if not self.layout.counts_surfaces:
            return observation
        heights, layout = columns[..., MOTION_SIZE:], self.layout
        count = surface_count(heights, layout.rows, layout.columns, self.height_range)
        return jnp.concatenate([observation, count[..., None]], axis=-1)

    def start(self, motion: RootMotion, route: Route, memory: Any = ()) -> SteeringState:
        """Return the state at the beginning of an episode.

        Args:
            motion: motion of the root.
            route: route of the episode.
            memory: memory that the foresight's `begin` returned; empty without foresight.
        """
        zero = jnp.zeros_like(route.map_index)
        return SteeringState(
            motion, route, goal_index=zero, goal_age=zero, step=zero, memory=memory
        )

    def goal(self, state: SteeringState) -> Float[Array, "*batch 2"]:
        """Return the goal that is sought now [m]."""
        return _pick(state.plan.goals, state.goal_index)

    def step(
        self,
        atlas: Atlas,
        params: RewardParams,
        state: SteeringState,
        action: Float[Array, "*batch 4"],
    ) -> tuple[SteeringState, SeenResult]:
        """Advance one time step and look: `advance`, then `look`, with their arguments."""
        after, result = self.advance(atlas, params, state, action)
        return after, SeenResult(**vars(result), observation=self.look(atlas, after))

    def _judge_all(
        self, atlas: Atlas, state: SteeringState, motion: RootMotion
    ) -> tuple[Float[Array, "*batch"], Any]:
        """Return the margin of all conditions that end an episode, and the foresight's memory."""
        where = state.plan.map_index, motion.position, motion.yaw
        margin = self.margin(atlas, state.plan.map_index, motion)
        if self.foresight is None:
            return margin, state.memory

        def look_around(pick: Pick, points: np.ndarray) -> Array:
            map_index, position, yaw = map(pick, where)
            return atlas.heights_around(map_index, position, yaw, self.points_in_root[points])

        foreseen, memory = self.foresight.follow(state.memory, look_around, motion)
        return jnp.minimum(margin, foreseen), memory

    def advance(
        self,
        atlas: Atlas,
        params: RewardParams,
        state: SteeringState,
        action: Float[Array, "*batch 4"],
    ) -> tuple[SteeringState, SteeringResult]:
        """Advance one time step (T eq. 3.3), judge the configuration and reward it.

        Args:
            atlas: height maps of the terrains.
            params: weights of the reward.
            state: state of the episode.
            action: action of the network, in [-1, 1]^4.
        """
        config = self.config

        def move(motion: RootMotion, action: Array) -> tuple[Array, RootMotion]:
            command = scale_action(action, config.limits)
            return command, integrate(motion, command, config.limits)

        command, motion = compute_once(move, state.motion, action)
        margin, memory = self._judge_all(atlas, state, motion)
        valid = margin >= 0.0

        toward, distance = direction_to_goal(motion, self.goal(state))
        reached = distance <= config.goal_radius
        gained = reward(params, config, motion, command, toward, valid.astype(margin.dtype))

        age = state.goal_age + 1
        replaced = reached | (age >= _pick(state.plan.goal_steps, state.goal_index))
        after = SteeringState(
            motion=motion,
            plan=state.plan,
            goal_index=jnp.minimum(state.goal_index + replaced, GOALS - 1),
            goal_age=jnp.where(replaced, 0, age),
            step=state.step + 1,
            memory=memory,
        )
        return after, SteeringResult(
            reward=gained,
            terminated=~valid,
            truncated=valid & (after.step >= config.episode_steps),
            margin=margin,
            reached=reached & valid,
        )


def _pick(values: Array, index: Int[Array, "*batch"]) -> Array:
    """Return entry `index` along the goals' axis (the first after the batch axes)."""
    # Selecting among GOALS entries is cheaper on every backend than gathering one each.
    entries = [values[(slice(None),) * index.ndim + (number,)] for number in range(GOALS)]
    which = index.reshape(index.shape + (1,) * (entries[0].ndim - index.ndim))
    picked = entries[0]
    for number, entry in enumerate(entries[1:], start=1):
        picked = jnp.where(which == number, entry, picked)
    return picked
