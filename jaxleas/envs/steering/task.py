"""Steering as a task: its worlds, its starts, and the growing cost of a failure."""

from collections.abc import Collection, Mapping, Sequence
from functools import cached_property
from typing import Any, Self

import jax
from jax import Array
from jaxtyping import Float, Key

from jaxleas.conditions import Condition, Foresight
from jaxleas.envs import Examination, Starts, Task
from jaxleas.envs.steering.config import SteeringConfig
from jaxleas.envs.steering.env import SteeringEnv
from jaxleas.envs.steering.own_terrain import make_own_terrain
from jaxleas.envs.steering.reward import RewardParams
from jaxleas.envs.steering.starts import draw_starts
from jaxleas.envs.steering.state import SteeringResult, SteeringState
from jaxleas.envs.steering.terrain_config import TerrainConfig
from jaxleas.envs.steering.world import KINDS, OwnMaps, World, as_sensed, make_world
from jaxleas.terrain import generate_arena, read_own_terrain

NOT_CROSSED = ("flat", "obstacles", "cliff", "void")
STOPS = ("ledge", "gap", "barrier", "posts", "cliff", "void")
"""Kinds of links some of which cannot be crossed: there, staying valid is success."""
EASY = ("flat", "obstacles")
"""Kinds of links that every policy crosses."""


class Steering(Task):
    """A root that walks towards goals over terrain that it sees only locally (T ch. 3).

    Attributes:
        env: steering environment: motion, observation, conditions and reward.
    """

    Config = SteeringConfig
    Worlds = TerrainConfig
    groups = KINDS

    def __init__(
        self,
        config: SteeringConfig,
        worlds: TerrainConfig | None = None,
        condition: Condition | None = None,
        foresight: Foresight | None = None,
        allow: Collection[str] = (),
    ) -> None:
        """Prepare the task.

        Args:
            config: configuration of the task.
            worlds: configuration of its terrain; None: the default one.
            condition: condition that ends an episode, in place of the configuration's.
            foresight: condition with memory that also ends an episode, such as a surrogate of a
                contact planner.
            allow: user's own code that may be run, as MODULE:CLASS.
        """
        super().__init__(config, worlds or TerrainConfig())
        spare, delay = self.worlds.spare, self.worlds.noise.delay
        self.env = SteeringEnv(config, condition, foresight, allow, spare, delay)

    @classmethod
    def make(cls, config: Any, worlds: Any, allow: Collection[str] = ()) -> Self:
        """Return the task under the conditions that its configuration names."""
        return cls(config, worlds, allow=allow)

    def require_worlds(self) -> None:
        """Refuse terrain files that cannot be trained on."""
        files = self._own_maps
        if files is not None:
            make_own_terrain(files.robot, files.maps, files.share, first_map=0)

    @cached_property
    def _own_maps(self) -> OwnMaps | None:
        """Terrain files, read once; None: the configuration names none."""
        terrain = self.worlds
        if not terrain.files:
            return None
        maps = read_own_terrain(terrain.files, terrain.resolution)
        return OwnMaps(maps, terrain.files_share, self.env.robot)

    def make_world(self, seeds: Sequence[int], examined: bool) -> World:
        """Generate arenas, rasterise them, and list their links.

        Terrain files are used for training, too, but never for the examination.

        Arenas of the examination have no boxes, and crossings only unless the configuration asks
        for more: every goal can be reached, so that the score has room to the top and the best
        policy can be distinguished from the second.

        Raises:
            InputError: no arena has a link to cross.
        """
        terrain = self.worlds
        generator, shares = terrain.generator, terrain.shares.model_dump()
        if examined:
            clear = generator.obstacles.model_copy(update={"probability": 0.0})
            generator = generator.model_copy(update={"obstacles": clear})
            if terrain.examined == "all":
                shares = {kind: float(share > 0.0) for kind, share in shares.items()}
                shares |= dict.fromkeys(EASY, 0.0)
            else:
                shares |= dict.fromkeys((*NOT_CROSSED, *STOPS), 0.0)
        arenas = [generate_arena(generator, seed) for seed in seeds]
        files = None if examined else self._own_maps
        world = make_world(arenas, terrain.resolution, shares, files)
        if terrain.noise.is_none:
            return world
        return as_sensed(world, terrain.noise, jax.random.key(seeds[0]))

    def draw_starts(
        self, world: World, key: Key[Array, ""], count: int, examined: bool = False
    ) -> Starts:
        """Draw candidates: a random link, anywhere in its start area, any heading.

        In training some starts have a random goal; in the examination all have a link to cross.
        """
        return draw_starts(self.env, world, key, count, 0.0 if examined else None)

    def stagger(self, state: SteeringState, key: Key[Array, ""]) -> SteeringState:
        """Return first states as if their episodes had begun at different times."""
        step = jax.random.randint(key, state.step.shape, 0, self.config.episode_steps)
        return state.replace(step=step)  # type: ignore[attr-defined]

    def weights(self, numbers: Mapping[str, Any], progress: Any) -> RewardParams:
        """Return the reward's weights; that of a failure grows linearly during training."""
        return RewardParams.at(numbers, progress)

    def advance(
        self,
        world: World,
        weights: RewardParams,
        state: SteeringState,
        action: Float[Array, "*batch 4"],
        disturbance: Any = (),
    ) -> tuple[SteeringState, SteeringResult]:
        """Advance one time step (T eq. 3.3), judge the configuration and reward it."""
        del disturbance
        return self.env.advance(world.atlas, weights, state, action)

    def look(self, world: World, state: SteeringState) -> Float[Array, "*batch size"]:
        """Return the robots' observation of terrain, motion and goal."""
        return self.env.look(world.seen, state)

    def examination(self, held_out: Any) -> Examination:
        """Return the examination: links to cross, and those to stop at if the terrain says so."""
        terrain = self.worlds
        if terrain.examined == "crossings":
            return Examination(held_out.starts, held_out.steps)
        shares = terrain.shares.model_dump()
        kinds = [kind for kind in KINDS if shares[kind] > 0.0 and kind not in EASY]
        return Examination(
            held_out.starts,
            held_out.steps,
            cells=tuple(kind for kind in kinds if kind not in STOPS),
            stops=tuple(kind for kind in kinds if kind in STOPS),
            by_worst=True,
        )
