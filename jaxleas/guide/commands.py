"""The function behind `jaxleas rollout`."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Bool

from jaxleas.configuration import Allow
from jaxleas.guide.registry import SteeringName, find_method, require_guardable
from jaxleas.terrain import READING, Reading
from jaxleas.types import InputError

if TYPE_CHECKING:
    from jaxleas.envs.steering import SteeringEnv
    from jaxleas.guide.files import Reason
    from jaxleas.guide.rollout import RollOut
    from jaxleas.guide.steering_method import SteeringMethod
    from jaxleas.terrain import HeightMap, NoiseConfig
    from jaxleas.types import Query


@dataclass(frozen=True)
class Noise:
    """What is wrong with the map that robots see, and the seed from which it is drawn."""

    model: "NoiseConfig"
    seed: int


MAX_CONFIGURATIONS = 20_000_000  # in all paths together: about a gigabyte during the roll-out


def rollout(
    policy: Path,
    *,
    terrain: Path,
    queries: Path,
    out: Path,
    steps: int = 800,
    steering: SteeringName = "leas",
    picture: Path | None = None,
    exact: bool | None = None,
    guard: bool | None = None,
    noise: Sequence[str] | None = None,
    noise_seed: int = 0,
    reading: Reading = READING,
    allow: Allow = (),
) -> None:
    """Walk a policy on any terrain and write its guide paths.

    Args:
        policy: run folder, policy.npz, .onnx file, or pretrained:NAME.
        terrain: height map, scene, mesh, image, table or bag; docs/files.md lists all kinds.
        queries: file of the queries, .json: a list of {position, yaw, velocity, goal}.
        out: file of the guide paths, .npz.
        steps: maximum number of configurations after the first one of a path.
        steering: steering method: leas is the policy; kino, RB-Kino, and lin, RB-Lin, know no
            terrain.
        picture: draw the paths from above (.png, .svg, .pdf).
        exact: judge the paths once more, exactly, on the polygons of the terrain, and end each
            where it is refused; by default wherever the terrain has polygons.
        guard: brake before what R* and C refuse, even where the policy would not; by default as the
            policy's configuration states.
        noise: what is wrong with the map that policy and guard see, such as white=0.02
            missing=0.02: the settings of terrain.noise; paths are judged on the true terrain.
        noise_seed: seed from which it is drawn.
        reading: what the terrain file does not state itself.
        allow: conditions of your own under which the policy was trained and shall walk; by default
            it walks under R* and C.
    """
    from jaxleas.envs.steering import SteeringEnv
    from jaxleas.guide.failures import failures_on_map
    from jaxleas.guide.files import read_queries, require_on_terrain, write_guide_paths
    from jaxleas.guide.loading import load_policy
    from jaxleas.guide.picture import draw_guide_paths
    from jaxleas.guide.reconfirming import EndedPaths, polygons_of, reconfirm
    from jaxleas.guide.rollout import paths
    from jaxleas.guide.rollout_report import describe_paths, failure_lines, goals_off_the_map
    from jaxleas.terrain import import_terrain, noise_of, require_picture

    asked = read_queries(queries)
    _require_sizes(steps, len(asked), out)
    if picture is not None:
        require_picture(picture)
    wrong = noise_of(noise)
    if not 0 <= noise_seed < 2**31:
        raise InputError(f"--noise-seed is {noise_seed}; give one from 0 to {2**31 - 1}")
    named = find_method(steering)
    require_guardable(named, guard)
    loaded = load_policy(policy, allow, guard)
    ground = import_terrain(terrain, reading)
    require_on_terrain(queries, asked, ground)
    scene = polygons_of(terrain, reading, exact)
    env = SteeringEnv(loaded.config, allow=allow)
    config = env.config
    method = named.make(env, loaded)
    seen = None if wrong is None else Noise(wrong, noise_seed)
    walked = walk_queries(env, method, ground, asked, steps, seen)
    guide_paths = paths(walked, config.limits.time_step)
    reasons = reasons_of(walked)
    failures = failures_on_map(env, ground, guide_paths, reasons)
    found = EndedPaths(tuple(guide_paths), tuple(reasons), tuple(failures))
    if scene is not None:
        found = reconfirm(env.robot, scene, env.conditions, found)
    write_guide_paths(out, found.paths, found.reasons, robot=config.robot, failures=found.failures)
    if picture is not None:
        draw_guide_paths(picture, ground, found.paths, found.reasons, asked)
    drawn = f"; drawn in {picture}" if picture is not None else ""
    print(f"{out}: {describe_paths(found, exactly=scene is not None)}{drawn}")
    for line in (*goals_off_the_map(asked, ground), *failure_lines(found, out)):
        print(line)


def walk_queries(
    env: "SteeringEnv",
    method: "SteeringMethod",
    terrain: "HeightMap",
    queries: "Sequence[Query]",
    steps: int,
    noise: "Noise | None" = None,
) -> "RollOut":
    """Return the roll-out of queries on one height map, which robots may see with noise.

    Raises:
        InputError: with noise, no height is known around a start.
    """
    import jax
    import jax.numpy as jnp

    from jaxleas.geometry import wrap_angle_on_host
    from jaxleas.guide.places import walking_heights
    from jaxleas.guide.rollout import Trips, roll_out
    from jaxleas.terrain import make_atlas, sense
    from jaxleas.types import NO_GROUND_IN_ROOT, RootMotion

    yaw = np.array([query.yaw for query in queries])
    start = RootMotion(
        position=jnp.asarray([query.position for query in queries], jnp.float32),
        velocity=jnp.asarray([query.velocity for query in queries], jnp.float32),
        yaw=jnp.asarray(wrap_angle_on_host(yaw), jnp.float32),
    )
    # The height wanted at the goal: walking height; over the void, that of the start.
    goals = np.array([query.goal for query in queries])
    start_heights = np.array([query.position[2] for query in queries])
    height = walking_heights(env.robot, terrain.height_at(goals), start_heights)
    waypoints = np.concatenate([goals, height[:, None]], axis=1)[:, None, :]
    atlas, index = make_atlas([terrain]), jnp.zeros(len(queries), jnp.int32)
    sensed = None
    if noise is not None:
        sensed, _ = sense(atlas, noise.model, jax.random.key(noise.seed))
        known = env.local_heights(sensed, index, start) > NO_GROUND_IN_ROOT
        _require_known(np.asarray(known))
    trips = Trips(atlas, index, start, jnp.asarray(waypoints, jnp.float32), sensed)
    return roll_out(env, method, trips, steps, env.config.goal_radius)


def _require_known(known: Bool[np.ndarray, "N points"]) -> None:
    """Refuse starts around which no height is known."""
    blind = np.flatnonzero(~known.any(axis=1))
    if len(blind):
        raise InputError(
            f"--noise leaves no height known around the start of query {blind[0]}: lower missing"
            " or holes, or raise fill"
        )


def reasons_of(rollout: "RollOut") -> "list[Reason]":
    """Return why each walk ended."""
    reached, invalid = np.asarray(rollout.reached), np.asarray(rollout.invalid)
    return [
        "reached" if arrived else "invalid" if failed else "stopped"
        for arrived, failed in zip(reached, invalid, strict=True)
    ]


def _require_sizes(steps: int, count: int, out: Path) -> None:
    if steps < 1:
        raise InputError(f"--steps is {steps}; a path takes at least 1 step, 800 is usual")
    if count * (steps + 1) > MAX_CONFIGURATIONS:
        raise InputError(
            f"{count} queries of {steps} steps make more than {MAX_CONFIGURATIONS} configurations:"
            " give fewer steps, or fewer queries at once"
        )
    if Path(out).suffix != ".npz":
        raise InputError(f"--out {out}: guide paths are written as .npz")
