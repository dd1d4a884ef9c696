"""RB-Kino's connections: their number per second, and their distance from the least time.

    python -m benchmarks.connections --json benchmarks/results/rb_kino.json

A connection alone is the closed form; a tried connection is walked over the terrain as in a
roadmap, with every configuration judged.
"""

import argparse
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np

from benchmarks.measurements import Figure, Measurement, Metric, this_machine, write_measurements
from benchmarks.timing import seconds_a_call
from jaxleas.cli_guard import run_guarded
from jaxleas.envs.steering import SteeringConfig, SteeringEnv
from jaxleas.guide import BATCH, KINO, Places, axis_times, connect, make_navigator, one, rb_kino
from jaxleas.terrain import rasterise, transition
from jaxleas.types import RootMotion
from tests.guide.integrator_twin import can_last, least_time_twin, random_connections

TOGETHER = 4096
PAIRS = 10_000
EDGE = 1.5
"""Length of the connections that are tried [m]."""


def alone(runs: int) -> list[float]:
    """Return the connections per second of the closed form, `TOGETHER` per call."""
    limits = SteeringConfig().limits
    method, random = rb_kino(limits, 0.1), np.random.default_rng(0)
    motion = RootMotion(
        jnp.asarray(random.uniform(-3, 3, (TOGETHER, 3)), jnp.float32),
        jnp.asarray(random.uniform(-0.1, 0.1, (TOGETHER, 3)), jnp.float32),
        jnp.asarray(random.uniform(-3, 3, TOGETHER), jnp.float32),
    )
    goal = jnp.asarray(random.uniform(-3, 3, (TOGETHER, 3)), jnp.float32)
    solve: Callable = jax.jit(method.connection)
    return [TOGETHER / each for each in seconds_a_call(lambda: solve(motion, goal), runs)]


def tried(runs: int) -> list[float]:
    """Return the connections per second walked and judged on rubble, `BATCH` per call."""
    env = SteeringEnv(SteeringConfig())
    places = Places(env, rasterise(transition("rubble", 0).scene))
    method = rb_kino(env.config.limits, env.config.desired_speed)
    connector = make_navigator(places, method, KINO.edges, "rrt").connector
    random = np.random.default_rng(0)
    origin = places.draw(random, BATCH)
    angle = random.uniform(-np.pi, np.pi, BATCH)
    target = origin + EDGE * np.column_stack([np.cos(angle), np.sin(angle)])
    standing = places.standing(origin, angle)
    starts = [one(standing, index) for index in range(BATCH)]
    seconds = seconds_a_call(lambda: connector.connect(starts, target).reached, runs)
    return [BATCH / each for each in seconds]


def errors() -> tuple[float, int]:
    """Return the error of the axes' times against the twin's [s], and how many joint times fail.

    A joint time fails if the twin cannot arrive at it on every axis, or if it can arrive a
    microsecond earlier, at one of the times at which an axis becomes possible.
    """
    pairs = random_connections(PAIRS)
    with jax.enable_x64(True):
        arrays = [jnp.asarray(each) for each in pairs]
        least, begin, end = (np.asarray(each) for each in jax.jit(axis_times)(*arrays))
        duration = np.asarray(jax.jit(connect)(*arrays).duration)[:, None]
    error = float(np.abs(least - least_time_twin(*pairs)).max())
    late = can_last(duration + 1e-6, *pairs) | (np.abs(duration - begin) < 1e-5)
    wrong = ~late.all(axis=1)
    candidates = np.concatenate([least, end], axis=1)
    earlier = np.where(candidates < duration - 1e-6, candidates + 1e-9, -1.0)
    for column in earlier.T:
        wrong |= np.all(can_last(column[:, None], *pairs), axis=1)
    return error, int(wrong.sum())


def main(arguments: Sequence[str]) -> None:
    """Measure and write."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--json", type=Path, required=True)
    parser.add_argument("--runs", type=int, default=5)
    given = parser.parse_args(arguments)
    error, wrong = errors()
    figures = [
        (Metric("rb_kino_alone", "connections/s"), Figure(alone(given.runs))),
        (Metric("rb_kino_tried", "connections/s"), Figure(tried(given.runs))),
        (Metric("rb_kino_time_error", "s", better="lower"), Figure([error], limit=1e-6)),
        (Metric("rb_kino_joint_times_wrong", f"of {PAIRS}", better="lower"), Figure([wrong])),
    ]
    machine = this_machine()
    measured = [Measurement.of(metric, figure, machine) for metric, figure in figures]
    write_measurements(given.json, measured)
    for each in measured:
        print(f"{each.name:28}{each.value:>12.5g} {each.unit}")


if __name__ == "__main__":
    sys.exit(run_guarded(lambda: main(sys.argv[1:])))
