"""Many guide paths judged in parallel processes (T 4.2); what is done stays done."""

import os
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from contextlib import contextmanager
from multiprocessing import get_context
from pathlib import Path

from jaxleas.contacts.sampling import SamplingSettings
from jaxleas.guide.files import read_guide_paths
from jaxleas.labels.planners import judge, require_planner
from jaxleas.labels.shards import Shard, provenance_of, write_shard
from jaxleas.terrain.scene import read_scene
from jaxleas.types.errors import InputError

GUIDES_A_SHARD = 64
"""Enough to work on abreast, few enough to lose when interrupted."""
_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")


def plan_shards(
    guides: Sequence[Path],
    scene: Path,
    planner: str,
    settings: SamplingSettings,
    out: Path,
    a_shard: int = GUIDES_A_SHARD,
) -> list[Shard]:
    """Return the shards of guide path files: `out/<file's stem>/verdicts_<first>.json`.

    Raises:
        InputError: a file cannot be used, or two have the same name.
    """
    require_planner(planner)
    read_scene(scene)
    stems = [path.stem for path in guides]
    twice = sorted({stem for stem in stems if stems.count(stem) > 1})
    if twice:
        raise InputError(f"two guide path files are called {twice[0]}: give each its own name")
    shards = []
    for path in guides:
        count = len(read_guide_paths(path).paths)
        provenance = provenance_of(path, scene, planner, settings)
        for first in range(0, count, a_shard):
            name = Path(out) / path.stem / f"verdicts_{first:06d}.json"
            last = min(first + a_shard, count)
            shards.append(Shard(path, scene, planner, settings, first, last, name, provenance))
    return shards


def judge_shard(shard: Shard) -> int:
    """Judge one shard, write its file, and return the number of its guide paths.

    Only names and numbers reach a worker; it reads guide paths and scene itself.
    """
    scene = read_scene(shard.scene)
    paths = read_guide_paths(shard.guides).paths[shard.first : shard.last]
    write_shard(shard, judge(shard.planner, scene, paths, shard.settings, shard.first))
    return len(paths)


def label_shards(
    shards: Sequence[Shard], processes: int, on_done: Callable[[int], None]
) -> tuple[int, int]:
    """Judge the shards that are not done, several at a time.

    Args:
        shards: of `plan_shards`.
        processes: working at the same time; 1 works in this process.
        on_done: called with a number of guide paths whenever so many more are done.

    Returns:
        Numbers of guide paths judged now and found judged before.

    Raises:
        InputError: a verdict file is there that does not belong to these guide paths.
    """
    open_ = [shard for shard in shards if not shard.is_done]
    before = sum(shard.last - shard.first for shard in shards) - sum(
        shard.last - shard.first for shard in open_
    )
    on_done(before)
    judged = 0
    if processes <= 1 or len(open_) <= 1:
        for shard in open_:
            judged += judge_shard(shard)
            on_done(shard.last - shard.first)
        return judged, before
    with (
        _one_thread_each(),
        ProcessPoolExecutor(min(processes, len(open_)), mp_context=get_context("spawn")) as pool,
    ):
        waiting = [pool.submit(judge_shard, shard) for shard in open_]
        try:
            for future in as_completed(waiting):
                done = future.result()
                judged += done
                on_done(done)
        except BaseException:
            pool.shutdown(cancel_futures=True)
            raise
    return judged, before


@contextmanager
def _one_thread_each() -> Iterator[None]:
    """Let each worker's linear algebra use one thread: the processes are the parallelism."""
    before = {name: os.environ.get(name) for name in _THREADS}
    os.environ.update(dict.fromkeys(_THREADS, "1"))
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value
