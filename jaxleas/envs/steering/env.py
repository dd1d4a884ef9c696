"""LEAS steering as pure functions: a robot's root, a terrain, a goal (T ch. 3)."""

from collections.abc import Collection
from typing import Any

import jax.numpy as jnp
import numpy as np
from jax import Array
from jaxtyping import Float, Int

from jaxleas.conditions import (
    Condition,
    Foresight,
    MarginFunction,
)
from jaxleas.envs.steering.config import SteeringConfig
from jaxleas.envs.steering.endings import Endings, Given
from jaxleas.envs.steering.feelers import Feelers
from jaxleas.envs.steering.guard import guard_of
from jaxleas.envs.steering.layout import ACTION_SIZE, layout_named
from jaxleas.envs.steering.motion import integrate, scale_action
from jaxleas.envs.steering.observation import direction_to_goal
from jaxleas.envs.steering.reward import RewardParams, reward
from jaxleas.envs.steering.sight import Sight, sampled_points
from jaxleas.envs.steering.state import (
    GOALS,
    Past,
    Route,
    SeenResult,
    SteeringResult,
    SteeringState,
)
from jaxleas.robots import load_robot
from jaxleas.terrain import Atlas, SensedAtlas, Terrains
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
        height_range: bounds to which seen heights are clipped, relative to the root [m].
        points_in_root: points at which the local terrain is sampled [m].
        endings: conditions under which an episode goes on.
        guard: guard that watches over a policy's roll-outs; None: there is none. Training is not
            guarded.
        sight: what a robot sees.
        delay: number of time steps by which robots see their maps late.
    """

    action_size = ACTION_SIZE

    def __init__(
        self,
        config: SteeringConfig,
        condition: Condition | MarginFunction | None = None,
        foresight: Foresight | None = None,
        allow: Collection[str] = (),
        spare: float = 0.0,
        delay: int = 0,
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
            delay: number of time steps by which maps are late (`NoiseConfig.delay`).

        Raises:
            InputError: a condition that the configuration names cannot be made.
        """
        self.config, self.delay = config, delay
        self.layout = layout_named(config.observation)
        self.robot = load_robot(config.robot)
        self.height_range = (config.height_low, config.height_high)
        sampled = sampled_points(config, self.robot)
        given = Given(condition, foresight, allow)
        self.endings = Endings(config, self.robot, sampled, given, spare)
        self.points_in_root = self.endings.points_in_root
        self.guard = guard_of(config, self.robot, sampled) if config.guard.enabled else None
        feelers = None
        if self.layout.feelers:
            feelers = Feelers(self.robot, self.layout.feelers, self.endings.at)
            # All of them, also those known already: they are read as one block.
            self.points_in_root = np.concatenate([self.points_in_root, feelers.points_in_root])
        self.sight = Sight(self.layout, self.height_range, feelers)

    @property
    def condition(self) -> Condition:
        """Condition on local terrain and motion; an episode ends where it fails."""
        return self.endings.condition

    @property
    def conditions(self) -> dict[str, Condition]:
        """Conditions that together are `condition`, by name."""
        return self.endings.conditions

    @property
    def foresight(self) -> Foresight | None:
        """Condition with memory, such as a surrogate of a contact planner, if there is one."""
        return self.endings.foresight

    def local_heights(
        self, atlas: Terrains, map_index: Int[Array, "*batch"], motion: RootMotion
    ) -> Float[Array, "*batch points"]:
        """Return the local terrain: heights at `points_in_root` relative to the root [m]."""
        return atlas.heights_around(map_index, motion.position, motion.yaw, self.points_in_root)

    def margin(
        self, atlas: Atlas, map_index: Int[Array, "*batch"], motion: RootMotion
    ) -> Float[Array, "*batch"]:
        """Return the margin of the conditions that need no memory [m]."""
        return self.endings.margin(atlas, map_index, motion)

    def observe(
        self,
        heights_in_root: Float[Array, "*batch points"],
        motion: RootMotion,
        goal: Float[Array, "*batch 2"],
    ) -> Float[Array, "*batch size"]:
        """Return the observation of a robot that seeks `goal` on this local terrain."""
        return self.sight.observe(heights_in_root, motion, goal)

    def look(self, atlas: Terrains, state: SteeringState) -> Float[Array, "*batch size"]:
        """Return the robots' observation: as `observe` on their local terrain, in one pass."""
        if self.delay and isinstance(atlas, SensedAtlas):
            atlas = atlas.late(state.past.lag(state.motion))
        return self.sight.look(atlas, state.plan.map_index, state.motion, self.goal(state))

    def start(self, motion: RootMotion, route: Route, memory: Any = ()) -> SteeringState:
        """Return the state at the beginning of an episode.

        Args:
            motion: motion of the root.
            route: route of the episode.
            memory: memory that the foresight's `begin` returned; empty without foresight.
        """
        zero = jnp.zeros_like(route.map_index)
        past = Past.of(motion, self.delay) if self.delay else ()
        return SteeringState(
            motion, route, goal_index=zero, goal_age=zero, step=zero, memory=memory, past=past
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
        seen: Terrains | None = None,
    ) -> tuple[SteeringState, SeenResult]:
        """Advance one time step and look: `advance`, then `look`, with their arguments.

        The terrain is seen as it is, unless `seen` says how.
        """
        after, result = self.advance(atlas, params, state, action)
        observation = self.look(atlas if seen is None else seen, after)
        return after, SeenResult(**vars(result), observation=observation)

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
        margin, memory = self.endings.follow(atlas, state, motion)
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
            past=state.past.then(state.motion) if self.delay else (),
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
