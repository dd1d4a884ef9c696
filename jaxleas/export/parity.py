"""Do the artifacts compute what the policy computes? Asked on what a robot really sees."""

from collections.abc import Callable
from functools import partial

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array
from jaxtyping import Float, Int, Key

from jaxleas.envs.steering.env import SteeringEnv
from jaxleas.envs.steering.starts import draw_starts, take
from jaxleas.envs.steering.world import World
from jaxleas.export.errors import ExportError
from jaxleas.export.stablehlo import stablehlo_from_bytes
from jaxleas.guide.leas import Leas
from jaxleas.guide.onnx_policy import onnx_policy_from_bytes
from jaxleas.guide.rollout import Trips, roll_out
from jaxleas.training.policy import SteeringPolicy

TOLERANCE = 1e-5  # [m/s^2] and [rad/s]
LEAST_OBSERVATIONS = 10_000


def record_observations(
    policy: SteeringPolicy,
    env: SteeringEnv,
    world: World,
    key: Key[Array, ""],
    robots: int = 128,
    steps: int = 200,
) -> Float[np.ndarray, "count size"]:
    """Return 10,000 or more observations of the policy's own walks, and edge cases after them.

    Robots walk across random links, each to its end or for `steps` steps, in as many rounds as it
    takes (a policy that falls at once needs more of them).

    Args:
        policy: that walks.
        env: that observes.
        world: terrains and links.
        key: consumed here.
        robots: that walk at once.
        steps: most steps of each.
    """
    recorded: list[np.ndarray] = []
    while sum(map(len, recorded)) < LEAST_OBSERVATIONS:
        key, round_key = jax.random.split(key)
        seen, end = _record_round(policy, env, world, round_key, robots, steps)
        walking = np.arange(steps + 1)[None, :] <= np.asarray(end)[:, None]
        recorded.append(np.asarray(seen)[walking])
    return np.concatenate([*recorded, edge_cases(policy)])


@partial(jax.jit, static_argnames=("env", "robots", "steps"))
def _record_round(
    policy: SteeringPolicy, env: SteeringEnv, world: World, key: Array, robots: int, steps: int
) -> tuple[Float[Array, "robots T+1 size"], Int[Array, " robots"]]:
    """Return what every robot sees in all configurations, and the index of its last one."""
    pool_key, take_key = jax.random.split(key)
    episode, _ = take(draw_starts(env, world, pool_key, 4 * robots), take_key, robots)
    map_index, goal = episode.plan.map_index, episode.plan.goals[:, :1]
    waypoints = jnp.pad(goal, ((0, 0), (0, 0), (0, 1)))  # LEAS does not look at a goal's height
    trips = Trips(world.atlas, map_index, episode.motion, waypoints)
    walked = roll_out(env, Leas(policy, env), trips, steps)
    heights = env.local_heights(
        world.atlas, jnp.broadcast_to(map_index[:, None], walked.yaw.shape), walked.motion
    )
    goal = jnp.broadcast_to(goal, (*walked.yaw.shape, 2))
    return env.observe(heights, walked.motion, goal), walked.end


def edge_cases(policy: SteeringPolicy) -> Float[np.ndarray, "cases size"]:
    """Return observations at the ends of their ranges, and one value at a time far beyond."""
    mean, deviation = np.asarray(policy.mean), np.asarray(policy.deviation)
    levels = (-1.0, -1e-6, 0.0, 1e-6, 1.0)
    whole = [mean + level * deviation for level in levels]
    # The clip must catch these. Not all values at once: no terrain does that, and float32 sums of
    # a hundred large terms differ by more than the tolerance without anything being wrong.
    single = [
        mean + level * deviation * np.eye(len(mean))[index]
        for level in (-1e6, -1.0, 1.0, 1e6)
        for index in range(len(mean))
    ]
    return np.array([*whole, *single], dtype=np.float32)


def largest_difference(
    policy: SteeringPolicy,
    onnx_file: bytes,
    stablehlo: bytes,
    observations: Float[np.ndarray, "count size"],
) -> dict[str, float]:
    """Return how far the artifacts are from JAX on these observations.

    Args:
        policy: as JAX computes it.
        onnx_file: content of the ONNX file, run by onnxruntime.
        stablehlo: serialised StableHLO.
        observations: at least 10,000, in physical units.

    Returns:
        The largest absolute difference of each, [m/s^2] or [rad/s].

    Raises:
        ExportError: there are too few observations, or a difference is above `TOLERANCE`.
    """
    observations = np.asarray(observations, np.float32)
    if len(observations) < LEAST_OBSERVATIONS:
        raise ExportError(
            f"the artifacts must be compared on at least {LEAST_OBSERVATIONS} observations, not"
            f" on {len(observations)}; nothing was written"
        )
    with jax.default_matmul_precision("highest"):  # as the artifacts compute, on any device
        expected = np.asarray(jax.jit(policy.__call__)(observations))
    artifacts: dict[str, Callable] = {
        "onnxruntime": onnx_policy_from_bytes(onnx_file, "policy.onnx"),
        "stablehlo": stablehlo_from_bytes(stablehlo),
    }
    differences = {}
    for name, artifact in artifacts.items():
        gap = float(np.max(np.abs(np.asarray(artifact(observations)) - expected)))
        if not gap <= TOLERANCE:  # a NaN is a difference too
            raise ExportError(
                f"{name} and JAX differ by {gap:.3g} on {len(observations)} recorded observations,"
                f" more than {TOLERANCE:g}; nothing was written"
            )
        differences[name] = gap
    return differences
