"""Many guide path files judged in parallel (T 4.2); finished work is kept."""

from collections.abc import Callable, Sequence
from pathlib import Path

from jaxleas.guide import read_guide_paths
from jaxleas.labels.oracle import Oracle
from jaxleas.labels.planners import judge
from jaxleas.labels.shards import Asked, Shard, write_shard
from jaxleas.robots import robot_for
from jaxleas.terrain import load_scene
from jaxleas.types import InputError
from jaxleas.workers import Workers


def make_shards(
    guides: Sequence[Path], scene: Path, oracle: Oracle, out: Path, a_shard: int | None = None
) -> list[Shard]:
    """Return the shards of guide path files: `out/<file's stem>/verdicts_<first>.json`.

    Args:
        guides: guide path files.
        scene: scene file that they cross.
        oracle: planner to ask.
        out: folder of the verdict files.
        a_shard: number of guide paths per shard; a number that suits the planner if None.

    Raises:
        InputError: a file cannot be used, two have the same name, a path is another
            robot's, or the settings do not fit.
    """
    planner, settings = oracle.find()
    size = a_shard or planner.grain.shard
    load_scene(scene)
    stems = [path.stem for path in guides]
    twice = sorted({stem for stem in stems if stems.count(stem) > 1})
    if twice:
        raise InputError(f"two guide path files are called {twice[0]}: give each its own name")
    shards = []
    for path in guides:
        file = read_guide_paths(path)
        robot_for(file.robot, oracle.robot, path)
        count = len(file.paths)
        asked = Asked(path, scene, oracle.planner, settings, oracle.robot)
        provenance = asked.provenance()
        for first in range(0, count, size):
            name = Path(out) / path.stem / f"verdicts_{first:06d}.json"
            shards.append(Shard(asked, first, min(first + size, count), name, provenance))
    return shards


def judge_shard(shard: Shard) -> int:
    """Judge one shard, write its file, and return the number of its guide paths.

    Only names and numbers reach a worker; it reads guide paths and scene itself. A shard whose
    file exists already was written by a worker that died before it could report.
    """
    if not shard.is_done:
        asked = shard.asked
        scene = load_scene(asked.scene)
        paths = read_guide_paths(asked.guides).paths[shard.first : shard.last]
        verdicts = judge(
            asked.planner, scene, paths, asked.settings, shard.first, robot=asked.robot
        )
        write_shard(shard, verdicts)
    return len(shard)


def label_shards(
    shards: Sequence[Shard], workers: Workers, on_done: Callable[[int], None]
) -> tuple[int, int]:
    """Judge the shards that are not done, several at a time.

    Args:
        shards: shards from `make_shards`.
        workers: workers that judge the shards.
        on_done: function called with the number of further guide paths that are done.

    Returns:
        Numbers of guide paths judged now and found judged before.

    Raises:
        InputError: a verdict file exists that does not belong to these guide paths.
        WorkerError: workers die over the same shard repeatedly.
    """
    open_ = [shard for shard in shards if not shard.is_done]
    before = sum(map(len, shards)) - sum(map(len, open_))
    on_done(before)
    judged = 0
    for _, done in workers.run(judge_shard, open_):
        judged += done
        on_done(done)
    return judged, before
