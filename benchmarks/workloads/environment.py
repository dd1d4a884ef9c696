"""Steps a second of the environment alone, under random actions, restarts included."""

from functools import partial

import jax
from jax import Array

from benchmarks.context import Context
from benchmarks.measurements import Figure, Metric
from benchmarks.timing import seconds_a_call
from benchmarks.workloads.workload import Workload
from jaxleas.envs.steering.env import SteeringEnv
from jaxleas.envs.steering.layout import ICRA81, THESIS144
from jaxleas.envs.steering.reward import RewardParams
from jaxleas.envs.steering.starts import draw_starts, restart_where, take
from jaxleas.envs.steering.world import World

SIZES = (256, 1024, 4096, 16_384, 65_536)
QUICK_SIZES = (256, 4096)


def _measure(layout: str, robots: int, context: Context) -> dict[str, Figure]:
    settings = {"observation": layout}
    env = SteeringEnv(context.config.env.model_copy(update=settings))
    ppo = context.config.ppo
    walk = _make_walk(env, ppo.unroll, robots, ppo.candidates)
    held = [_begin(env, context.world, robots)]

    def call() -> Array:
        state, total = walk(context.world, held[0])
        held[0] = state
        return total

    steps = robots * ppo.unroll
    runs = [steps / seconds for seconds in seconds_a_call(call, context.runs)]
    rival = context.rival.figure("env") if layout == context.env.layout.name else None
    return {_name(layout, robots): Figure(runs, context.env_limit(env, robots), rival)}


def _begin(env: SteeringEnv, world: World, robots: int):
    pool_key, take_key, key = jax.random.split(jax.random.key(0), 3)
    pool = jax.jit(lambda: draw_starts(env, world, pool_key, robots))()
    return *take(pool, take_key, robots), key


def _make_walk(env: SteeringEnv, unroll: int, robots: int, candidates: int):
    """Return what the roll-out of training does, without a policy: walk `unroll` steps."""
    weights = RewardParams.of(env.config.reward)

    @partial(jax.jit, donate_argnums=1)
    def walk(world: World, state):
        episode, observation, key = state
        key, pool_key, action_key, restart_key = jax.random.split(key, 4)
        pool = draw_starts(env, world, pool_key, candidates)
        shape = (unroll, robots, env.action_size)
        actions = jax.random.uniform(action_key, shape, minval=-1.0)

        def advance(carry, inputs):
            episode, _ = carry
            action, key_now = inputs
            after, outcome = env.step(world.atlas, weights, episode, action)
            done = outcome.terminated | outcome.truncated
            return restart_where(done, after, outcome.observation, pool, key_now), outcome.reward

        keys = jax.random.split(restart_key, unroll)
        (episode, observation), reward = jax.lax.scan(
            advance, (episode, observation), (actions, keys)
        )
        return (episode, observation, key), reward.sum()

    return walk


def _name(layout: str, robots: int) -> str:
    return f"env_{layout}_{robots}"


ENVIRONMENT = tuple(
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
)
