"""Steps per second of the environment alone, with random actions, restarts included.

One jitted scan over donated state, as in training; the host waits once per run, not once per call.
"""

from functools import partial

import jax
import jax.numpy as jnp
from jax import Array

from benchmarks.context import Context, changed
from benchmarks.measurements import Figure, Metric
from benchmarks.spread import all_devices
from benchmarks.timing import not_far_ahead, seconds_a_call
from benchmarks.workloads.workload import Workload
from jaxleas.envs import draw_picks, pool_of, restart_where
from jaxleas.envs.steering import (
    ICRA81,
    THESIS144,
    RewardParams,
    Steering,
    SteeringEnv,
    World,
    begin,
    draw_starts,
)
from jaxleas.training import training_world

SIZES = (256, 1024, 4096, 16_384, 65_536)
QUICK_SIZES = (256, 4096)
ARENAS, ARENA_ROBOTS = (16, 256), 4096


def _measure(layout: str, robots: int, context: Context) -> dict[str, Figure]:
    env = SteeringEnv(context.config.env.model_copy(update={"observation": layout}))
    runs = rates(env, context.world, robots, context)
    rival = context.rival.figure("env") if layout == context.env.layout.name else None
    return {_name(layout, robots): Figure(runs, context.env_limit(env, robots), rival)}


def _of_arenas(arenas: int, context: Context) -> dict[str, Figure]:
    config = changed(context.config, terrain={"arenas": arenas})
    world = training_world(config, Steering(config.env, config.terrain))
    # The roofs were measured over the shipped terrain: no limit.
    return {f"env_arenas_{arenas}": Figure(rates(context.env, world, ARENA_ROBOTS, context))}


def _without_restarts(context: Context) -> dict[str, Figure]:
    """Measure the step alone: robots that have failed walk on."""
    runs = rates(context.env, context.world, ARENA_ROBOTS, context, restarts=False)
    return {WITHOUT_RESTARTS: Figure(runs, context.env_limit(context.env, ARENA_ROBOTS))}


def rates(
    env: SteeringEnv, world: World, robots: int, context: Context, restarts: bool = True
) -> list[float]:
    """Return the steps per second, one value per run."""
    ppo = context.config.ppo
    walk = _make_walk(env, ppo.unroll, robots, ppo.candidates if restarts else 0)
    devices = all_devices(robots)
    world = jax.device_put(world, devices.whole)
    episode, observation, key = _begin(env, world, robots)
    walking = jax.device_put((episode, observation), devices.divided)
    held = [(*walking, jax.device_put(key, devices.whole))]

    def call() -> Array:
        held[0], total = walk(world, held[0])
        return total

    return [
        robots * ppo.unroll / seconds
        for seconds in seconds_a_call(not_far_ahead(call), context.runs)
    ]


def _begin(env: SteeringEnv, world: World, robots: int):
    pool_key, take_key, key = jax.random.split(jax.random.key(0), 3)
    start = jax.jit(lambda: begin(env, world, (pool_key, take_key), robots, of=robots))
    return *start(), key


def _make_walk(env: SteeringEnv, unroll: int, robots: int, candidates: int):
    """Return a function that walks `unroll` steps, as the roll-out of training without a policy.

    Without candidates for fresh starts no robot is restarted.
    """
    weights = RewardParams.of(env.config.reward)

    @partial(jax.jit, donate_argnums=1)
    def walk(world: World, state):
        episode, observation, key = state
        key, pool_key, action_key, restart_key = jax.random.split(key, 4)
        pool = pool_of(draw_starts(env, world, pool_key, candidates)) if candidates else None
        # Two actions from each random word: drawing them is not the environment's work.
        shape = (unroll, robots, env.action_size)
        words = jax.random.bits(action_key, (*shape[:2], env.action_size // 2))
        halves = jax.lax.bitcast_convert_type(words, jnp.uint16).reshape(shape)
        actions = halves.astype(jnp.float32) / 2**15 - 1.0

        def advance(carry, inputs):
            episode, _ = carry
            action, pick = inputs
            episode, verdict = env.advance(world.atlas, weights, episode, action)
            if pool is not None:
                done = verdict.terminated | verdict.truncated
                episode = restart_where(done, episode, pool, pick)
            return (episode, env.look(world.atlas, episode)), verdict.reward

        picks = draw_picks(pool, restart_key, shape[:2]) if pool else None
        (episode, observation), reward = jax.lax.scan(
            advance, (episode, observation), (actions, picks)
        )
        return (episode, observation, key), reward.sum()

    return walk


def _name(layout: str, robots: int) -> str:
    return f"env_{layout}_{robots}"


WITHOUT_RESTARTS = f"env_without_restarts_{ARENA_ROBOTS}"
ENVIRONMENT = (
    *(
        Workload(
            (
                Metric(
                    _name(layout, robots),
                    "steps/s",
                    quick=layout == THESIS144.name and robots in QUICK_SIZES,
                ),
            ),
            partial(_measure, layout, robots),
        )
        for layout in (THESIS144.name, ICRA81.name)
        for robots in SIZES
    ),
    Workload((Metric(WITHOUT_RESTARTS, "steps/s"),), _without_restarts),
    *(
        Workload((Metric(f"env_arenas_{each}", "steps/s", quick=False),), partial(_of_arenas, each))
        for each in ARENAS
    ),
)
