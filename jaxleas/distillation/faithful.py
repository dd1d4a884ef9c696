"""Faithful mode, the thesis's own: the exact planner in the loop (T 3.3.3, fig. 3.11b).

The policy walks waves of whole episodes on the device; workers judge their guide paths while it
walks on; failed tails are cut; PPO learns from what is left. What the device walks is at most
`ahead` waves old, and verdicts are taken in the order of the walks, whatever the order of the
answers: so an uninterrupted run is as reproducible as its planner.
"""

from collections import deque
from collections.abc import Callable, Generator
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, field
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from jaxleas.distillation.config import FaithfulConfig, SteeringRun
from jaxleas.distillation.cutting import Stream, cut, to_experience
from jaxleas.distillation.episodes import Episodes, make_walk, to_host
from jaxleas.distillation.faithful_metrics import Tally, batch_metrics
from jaxleas.envs.steering import Steering, World
from jaxleas.labels import Judge
from jaxleas.terrain import Scene
from jaxleas.training import (
    Learned,
    PpoParams,
    TrainState,
    initial_normaliser,
    make_networks,
    make_optimiser,
    make_update,
)
from jaxleas.types import Verdict

Wave = tuple[Episodes, list[Verdict]]


@dataclass
class Faithful:
    """The pieces of one faithful training.

    Attributes:
        config: configuration of the run.
        faithful: configuration of the waves: how much is walked at once, and how far ahead.
        task: steering task.
        world: terrains to train on.
        scenes: exact scenes of the same terrains.
        judge: exact planner, with its workers.
        stream: accepted steps that wait to be learned from.
        tally: counts of what has been walked and judged since the last update.
    """

    config: SteeringRun
    faithful: FaithfulConfig
    task: Steering
    world: World
    scenes: tuple[Scene, ...]
    judge: Judge
    stream: Stream = field(init=False)
    tally: Tally = field(init=False)

    def __post_init__(self) -> None:
        self.networks = make_networks(self.config.network, self.config.env.signature())
        robots = self.faithful.robots
        self._walk = jax.jit(make_walk(self.config, self.task.env, self.networks, robots))
        self._update = jax.jit(make_update(self.config, self.networks))
        self._empty()

    def _empty(self) -> None:
        self.stream = Stream(self.config.ppo.environments, self.config.ppo.unroll)
        self.tally = Tally()

    def fresh_state(self, learned: Learned | None) -> TrainState:
        """Return the state before the first update.

        Args:
            learned: networks to begin with, in place of fresh ones.

        Raises:
            InputError: the networks to begin with are of other sizes.
        """
        key, policy_key, value_key = jax.random.split(jax.random.key(self.config.seed), 3)
        params = self.networks.init(policy_key, value_key)
        state = TrainState(
            params=params,
            averaged=params.policy,
            optimiser=make_optimiser(self.config.ppo, PpoParams.of(self.config)).init(params),
            normaliser=initial_normaliser(self.config.network, self.networks.signature),
            episode=(),  # no episode outlasts its wave
            observation=(),  # type: ignore[arg-type]
            key=key,
            update=jnp.int32(0),
        )
        return state if learned is None else learned.into(state)

    def updates(
        self,
        state: TrainState,
        asked_to_stop: Callable[[], bool] = lambda: False,
        on_wave: Callable[[TrainState, int], None] = lambda state, waiting: None,
    ) -> Generator[tuple[TrainState, dict[str, Any]], None, None]:
        """Walk, judge and learn, until closed or asked to stop.

        Work in flight at that time is discarded: walked, perhaps judged, and not learned from.

        Args:
            state: state to continue from.
            asked_to_stop: function that returns whether to stop, called before each wave and
                update.
            on_wave: function called with the state and the number of waiting steps after each
                judged wave.

        Yields:
            The state and metrics after each update.
        """
        self._empty()
        bench = ThreadPoolExecutor(1, thread_name_prefix="exact-planner")
        flying: deque[Future[Wave]] = deque()
        try:
            while not asked_to_stop():
                batch = self.stream.batch()
                if batch is not None:
                    state, metrics = self.learn(state, batch)
                    yield state, metrics
                    continue
                while len(flying) <= self.faithful.ahead:
                    key, walk_key = jax.random.split(state.key)
                    walked = self._walk(self.world, state, walk_key)
                    state = state.replace(key=key)  # type: ignore[attr-defined]
                    flying.append(bench.submit(self._ask, walked))
                episodes, verdicts = flying.popleft().result()
                self.tally.count(episodes, verdicts)
                self.stream.add(cut(episodes, verdicts))
                on_wave(state, len(self.stream))
        finally:
            bench.shutdown(wait=True, cancel_futures=True)

    def learn(
        self, state: TrainState, batch: dict[str, np.ndarray]
    ) -> tuple[TrainState, dict[str, Any]]:
        """Return the state after one update, and its metrics."""
        ppo = self.config.ppo
        key, learn_key = jax.random.split(state.key)
        walked = batch_metrics(batch, int(state.update)) | self.tally.take()
        experience, after = to_experience(batch, ppo.environments, ppo.unroll)
        state, learned = self._update(state, experience, after, learn_key)
        return state.replace(key=key), walked | jax.device_get(learned)  # type: ignore[attr-defined]

    def _ask(self, walked: Any) -> Wave:
        """Wait for a wave to be walked, and let the workers judge it, in the bench's thread."""
        episodes = to_host(walked)
        paths = episodes.walks.paths(self.task.env.config.limits.time_step)
        return episodes, self.judge.judge(self.scenes, paths, episodes.walks.map_index)


def staleness_bound(config: SteeringRun, faithful: FaithfulConfig) -> int:
    """Return the greatest number of updates between a step's walk and its being learned from.

    Before a wave's last step is learned from, at most `ahead` waves that were in flight before it,
    the wave itself and what waited for a full batch are: each fills a batch and so an update.
    """
    wave = faithful.robots * config.env.episode_steps
    return ((faithful.ahead + 1) * wave + config.ppo.batch) // config.ppo.batch
