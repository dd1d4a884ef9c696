"""A round's labels: walk the policy, choose what to ask, let the exact planner answer."""

import time
from collections.abc import Callable
from dataclasses import dataclass

import jax
import numpy as np
from jaxtyping import Float, Int

from jaxleas.distillation.collect import Walks, WalksWanted, collect
from jaxleas.distillation.config import CollectConfig
from jaxleas.distillation.folder import RoundFolder
from jaxleas.envs.steering import SteeringEnv, World
from jaxleas.files import write_json
from jaxleas.guide import Reason, write_guide_paths
from jaxleas.labels import Oracle, label_shards, make_shards
from jaxleas.surrogates import Surrogate, foreseen_failure, label_paths
from jaxleas.terrain import Scene, write_scene
from jaxleas.training import Policy
from jaxleas.workers import Workers


@dataclass(frozen=True)
class Ground:
    """Ground to walk guide paths on.

    Attributes:
        env: steering task.
        world: terrains that the policy is trained on.
        scenes: exact scenes of the same terrains, one for each map of the world's atlas.
    """

    env: SteeringEnv
    world: World
    scenes: tuple[Scene, ...]


@dataclass(frozen=True)
class Collection:
    """How a round's guide paths come about.

    Attributes:
        policy: policy that walks.
        surrogate: surrogate of the round before, to choose by; None in the first round.
        config: number, length and disturbances of the walks.
        seed: seed of the walks and of the choice.
    """

    policy: Policy
    surrogate: Surrogate | None
    config: CollectConfig
    seed: int


def label_round(
    folder: RoundFolder,
    ground: Ground,
    collection: Collection,
    oracle: Oracle,
    workers: Workers,
    progress: Callable[[int, int], None],
) -> None:
    """Leave scenes, guide paths and verdicts in a round's folder; what is there stays.

    Args:
        folder: folder of the round.
        ground: terrains to walk on.
        collection: guide paths to collect.
        oracle: exact planner to ask about them.
        workers: workers that ask it.
        progress: callable that is given the number of guide paths with verdicts, and the total.
    """
    begun = time.perf_counter()
    files = sorted(folder.labels.glob("guides_*.npz"))
    if not (folder.labels / "chosen.json").is_file():
        walks = _walk(ground, collection)
        paths = walks.paths(ground.env.config.limits.time_step)
        for number in np.unique(walks.map_index).tolist():
            chosen = [paths[row] for row in np.flatnonzero(walks.map_index == number)]
            cut: list[Reason] = ["stopped"] * len(chosen)
            write_scene(folder.labels / f"scene_{number:04d}.json", ground.scenes[number])
            guides = folder.labels / f"guides_{number:04d}.npz"
            write_guide_paths(guides, chosen, cut, robot=ground.env.config.robot)
        write_json(folder.labels / "chosen.json", {"guides": len(paths), "seed": collection.seed})
        files = sorted(folder.labels.glob("guides_*.npz"))
    shards = [
        shard
        for guides in files
        for shard in make_shards(
            [guides],
            guides.with_name(guides.name.replace("guides", "scene")).with_suffix(".json"),
            oracle,
            folder.labels / "verdicts",
        )
    ]
    total, done = sum(map(len, shards)), 0

    def advance(count: int) -> None:
        nonlocal done
        done += count
        progress(done, total)

    judged, _ = label_shards(shards, workers, advance)
    seconds = time.perf_counter() - begun
    write_json(folder.labelled, {"guides": total, "judged": judged, "seconds": round(seconds, 1)})


def _walk(ground: Ground, collection: Collection) -> Walks:
    config, surrogate = collection.config, collection.surrogate
    wanted = config.guides if surrogate is None else config.later_guides
    count = wanted if surrogate is None else wanted * config.candidates
    walks = collect(
        ground.env,
        ground.world,
        collection.policy,
        jax.random.key(collection.seed),
        WalksWanted(count, config.steps, np.array(config.disturbances)),
    )
    if surrogate is None or config.candidates == 1:
        return walks
    keep_every = surrogate.identity.keep_every
    paths = walks.paths(ground.env.config.limits.time_step)
    labelled = label_paths(
        paths,
        [len(path) for path in paths],
        walks.map_index.tolist(),
        keep_every,
        1 + config.steps // keep_every,
    )
    failure = foreseen_failure(surrogate, ground.env, ground.world.atlas, labelled)
    return walks[choose(failure, wanted, np.random.default_rng(collection.seed))]


def choose(
    failure: Float[np.ndarray, " N"], wanted: int, generator: np.random.Generator
) -> Int[np.ndarray, " wanted"]:
    """Choose candidates to ask about: half at random, half where the verdict is least sure.

    The random half keeps the labels honest where the surrogate is sure and wrong.

    Args:
        failure: foreseen probability of failure of each candidate.
        wanted: number to choose, at most N.
        generator: random generator to draw with.
    """
    order = generator.permutation(len(failure))
    at_random, rest = order[: wanted // 2], order[wanted // 2 :]
    unsure = failure[rest] * (1.0 - failure[rest])
    least_sure = rest[np.argsort(-unsure, kind="stable")[: wanted - len(at_random)]]
    return np.sort(np.concatenate([at_random, least_sure]))
