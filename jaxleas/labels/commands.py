"""The function behind `jaxleas label`."""

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Literal

from jaxleas.types.errors import InputError


def label(
    guides: Sequence[Path],
    *,
    scene: Path,
    out: Path,
    planner: Literal["sampling"] = "sampling",
    keep_every: int = 5,
    samples: int = 25_000,
    heuristic: Literal["fixed_step", "manipulability", "effort", "reference"] = "fixed_step",
    seed: int = 0,
    processes: int | None = None,
) -> None:
    """Judge guide paths by an exact planner, in parallel; verdicts that are there are kept.

    Args:
        guides: guide path files, .npz.
        scene: that they walk on, .json.
        out: folder of the verdict files; the same command goes on where it was interrupted.
        planner: that judges.
        keep_every: one configuration in so many is planned for.
        samples: leg configurations in the data base.
        heuristic: by which candidates are tried.
        seed: of the data base.
        processes: working at the same time; all cores by default.
    """
    from time import perf_counter

    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TimeRemainingColumn

    from jaxleas.contacts.sampling import SamplingSettings
    from jaxleas.labels.label import label_shards, plan_shards
    from jaxleas.labels.shards import read_verdicts

    for name, value in (("keep-every", keep_every), ("samples", samples)):
        if value < 1:
            raise InputError(f"--{name} is {value}; give 1 or more")
    if processes is not None and processes < 1:
        raise InputError(f"--processes is {processes}; give 1 or more")
    if seed < 0:
        raise InputError(f"--seed is {seed}; give 0 or more")
    settings = SamplingSettings(
        keep_every=keep_every, samples=samples, heuristic=heuristic, seed=seed
    )
    begun = perf_counter()
    shards = plan_shards([Path(each) for each in guides], Path(scene), planner, settings, Path(out))
    total = sum(shard.last - shard.first for shard in shards)
    console = Console(stderr=True)
    columns = ("guide paths", BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=console, disable=not console.is_terminal) as progress:
        task = progress.add_task("label", total=total)
        judged, before = label_shards(
            shards,
            processes or os.cpu_count() or 1,
            lambda count: progress.advance(task, count),
        )
    seconds = perf_counter() - begun
    verdicts = [verdict for _, verdict in read_verdicts(out)]
    good = sum(verdict.success for verdict in verdicts)
    print(
        f"{out}: {good} of {len(verdicts)} guide paths succeed with the {planner} planner; "
        f"{judged} judged now in {seconds:.1f} s, {before} before"
    )
