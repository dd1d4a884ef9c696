"""The function behind `jaxleas label`."""

import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from jaxleas.contacts import DEFAULT_JUDGE, PlannerName, find_planner, settings_from
from jaxleas.terrain import PLANE_SEARCH, READING, PlaneSearch, Reading, load_scene
from jaxleas.types import InputError, describe_endings

if TYPE_CHECKING:
    from jaxleas.files import FolderLock
    from jaxleas.workers import Workers


def label(
    guides: Sequence[Path],
    *,
    scene: Path,
    out: Path,
    planner: PlannerName = DEFAULT_JUDGE,
    robot: str | None = None,
    parameters: Sequence[str] | None = None,
    keep_every: int | None = None,
    samples: int | None = None,
    heuristic: Literal["fixed_step", "manipulability", "effort", "reference"] | None = None,
    seed: int | None = None,
    model: Literal["two_com", "feet"] | None = None,
    candidates: Literal["window", "rom"] | None = None,
    window: float | None = None,
    time_limit: float | None = None,
    max_combinations: int | None = None,
    weights: Literal["uniform", "guide"] | None = None,
    processes: int | None = None,
    workers: Literal["processes", "ray"] = "processes",
    reading: Reading = READING,
    search: PlaneSearch = PLANE_SEARCH,
) -> None:
    """Judge guide paths by an exact planner, in parallel; verdicts that are there are kept.

    Args:
        guides: guide path files, .npz.
        scene: terrain that they cross: a scene (.json), a mesh, or a map, whose surfaces are
            found; surfaces of a map, and a terrain that is moved or cropped, are judged as the
            scene that is written to OUT/scene.json.
        out: folder of the verdict files; the same command continues where it was interrupted.
        planner: planner that judges.
        robot: robot that walks; by default the one that walked the guide paths, or talos where
            their files do not say.
        parameters: any settings of the planner, such as longest_step=0.3.
        keep_every: plan for every N-th configuration; by default the planner's own number.
        samples: sampling: number of leg configurations in the data base, 25000 by default.
        heuristic: sampling: score that orders the candidates, fixed_step by default.
        seed: sampling: seed of the data base, 0 by default.
        model: mip, sl1m, astar: two_com (with the centre of mass) or feet; by default two_com where
            the robot has two feet and step polytopes of its centre of mass.
        candidates: mip, sl1m, astar: surfaces in a window (the default) or in the range of motion.
        window: mip, sl1m, astar: edge of that window [m]; 0.8 by default.
        time_limit: mip, sl1m, astar: time limit per guide path [s], 60 by default; a path not
            decided by then stays undecided.
        max_combinations: sl1m: number of combinations after which it gives up, 2000 by default;
            0: a path that the relaxation leaves undecided fails.
        weights: sl1m: weights of the slacks, uniform by default; guide: the guide path chooses.
        processes: number of processes that work at the same time; all cores by default.
        workers: processes on this machine, or ray: the cluster that RAY_ADDRESS names.
        reading: what the scene's file does not state itself.
        search: what counts as a surface, if the scene is a map.
    """
    from functools import cache
    from time import perf_counter

    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TimeRemainingColumn

    from jaxleas.labels.guide_files import read_guide_files
    from jaxleas.labels.label import label_shards, make_shards
    from jaxleas.labels.oracle import Oracle
    from jaxleas.labels.scenes import settled_scene, states_itself
    from jaxleas.labels.settings import settings_of, with_parameters
    from jaxleas.labels.shards import read_verdicts
    from jaxleas.workers import require_count

    given = {
        "keep_every": keep_every,
        "samples": samples,
        "heuristic": heuristic,
        "seed": seed,
        "model": model,
        "candidates": candidates,
        "window": window,
        "time_limit": time_limit,
        "max_combinations": max_combinations,
        "weights": weights,
    }
    given = with_parameters(given, settings_of(parameters or ()))
    settings = settings_from(find_planner(planner, [planner]), **given)
    if processes is not None:
        require_count(processes)
    begun = perf_counter()
    crossed = cache(lambda: load_scene(scene, reading, search))
    walked = read_guide_files(guides, crossed, robot)
    for note in (*walked.notes, settings.note_for(walked.robot)):
        if note:
            print(note)
    # Absolute: a worker elsewhere has another working directory.
    files = [Path(each).absolute() for each in guides]
    oracle = Oracle(planner, settings, robot=walked.robot)
    ground = Path(scene).absolute()
    if not states_itself(ground, reading, search):
        ground = settled_scene(crossed(), ground, Path(out).absolute())
    shards = make_shards(files, ground, oracle, Path(out).absolute())
    team = _engage(workers, processes, len(shards))
    console = Console(stderr=True)
    columns = ("guide paths", BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    try:
        with (
            _held(Path(out)),
            Progress(*columns, console=console, disable=not console.is_terminal) as progress,
        ):
            task = progress.add_task("label", total=sum(map(len, shards)))
            judged, before = label_shards(shards, team, lambda done: progress.advance(task, done))
    finally:
        team.close()
    seconds = perf_counter() - begun
    verdicts = read_verdicts(out)
    good = [each for each in verdicts if each[1].success]
    open_ = sum(not verdict.decided for _, verdict in verdicts)
    print(
        f"{out}: {len(good)} of {len(verdicts)} guide paths succeed with the {planner} planner"
        f"{f' ({describe_endings(walked.endings_of(good))})' if good else ''}"
        f"{f', {open_} undecided' if open_ else ''}; "
        f"{judged} judged now in {seconds:.1f} s, {before} before"
    )


def _held(out: Path) -> "FolderLock":
    """Return a lock on the folder of verdicts: two writers would judge every path twice.

    Raises:
        InputError: another process holds the lock, or it cannot be made.
    """
    from jaxleas.files import FolderLock

    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"cannot make the folder {out}: {error.strerror or error}") from error
    return FolderLock(out, "the label folder", "give another --out")


def _engage(workers: str, processes: int | None, tasks: int) -> "Workers":
    """Return workers: no more than there are tasks, and this process where one is enough."""
    from jaxleas.labels.judging import planner_workers

    if workers == "ray":
        from jaxleas.workers import RayWorkers

        return RayWorkers(processes)
    return planner_workers(max(1, min(processes or os.cpu_count() or 1, tasks)))
