"""The function behind `jaxleas gait collect`."""

import sys
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from jaxleas.configuration import Allow
from jaxleas.controllers import DEFAULT_CONTROLLER, ControllerName, find_controller
from jaxleas.files import FolderLock
from jaxleas.footsteps.collecting import DEFINITIONS, collect_shard, is_done, plan_shards
from jaxleas.footsteps.collection_runs import COLLECTED, plan_runs
from jaxleas.footsteps.collection_walk import CollectionSettings, RunFell
from jaxleas.footsteps.records import Definition, FootstepRecords
from jaxleas.physics import DEFAULT_BODY, load_body
from jaxleas.runs import Progress, collect_provenance
from jaxleas.types import InputError


def collect(
    *,
    out: Path,
    controller: ControllerName = DEFAULT_CONTROLLER,
    robot: str = DEFAULT_BODY,
    movements: Sequence[str] = COLLECTED,
    settings: CollectionSettings = CollectionSettings(),  # noqa: B008  # its fields are options
    allow: Allow = (),
) -> None:
    """Walk a controller on level ground in physics, and collect its footsteps.

    Each movement is commanded at tenths of the largest speed: constant, and going to each higher
    speed and back about every 1.5 s, at any phase of the gait. In 30 more runs movement and speed
    change at contacts, as a planner changes them. The same command continues where it was
    interrupted.

    Args:
        out: folder of the footsteps: thesis/ has those found by heights of feet, contact/ those
            found by measured contact.
        controller: controller that walks.
        robot: robot that walks, or its MJCF file (.xml).
        movements: movements that are commanded; 'changing' is all of them in turn.
        settings: how footsteps are collected.
        allow: controller of your own that may be run.
    """
    body = load_body(robot)
    walker = find_controller(controller, body, (controller, *allow))
    shards = plan_shards(plan_runs(movements), settings.at_once, out)
    provenance, _ = collect_provenance(sys.argv)
    with _held(out):
        waiting = [shard for shard in shards if not is_done(shard, walker, settings)]
        ticks = sum(len(shard.runs) for shard in waiting) * settings.ticks
        with Progress(ticks) as progress:
            told = _Told(progress)
            for shard in waiting:
                told.begin(len(shard.runs))
                told.add(*collect_shard(shard, body, walker, settings, provenance, told.tick))
    before = len(shards) - len(waiting)
    print(f"{out}: {len(waiting)} shards walked now, {before} were there; {told.fallen} runs fell")
    for definition in DEFINITIONS if waiting else ():
        print(told.counts_of(definition))


class _Told:
    """What a person is told of a collection on its way and at its end."""

    def __init__(self, progress: Progress) -> None:
        self._progress = progress
        self._walked = self._robots = self._ticks = 0
        self._kept = Counter[Definition]()
        self._rejected = {each: Counter[str]() for each in DEFINITIONS}
        self.fallen = 0

    def begin(self, robots: int) -> None:
        """Begin a shard of so many robots."""
        self._robots, self._ticks = robots, 0

    def tick(self) -> None:
        """Note that all robots of the shard have walked for one tick."""
        self._walked += self._robots
        self._ticks += 1
        if self._ticks % _SHOWN == 0:
            self._progress.update(self._walked, {"falls": str(self.fallen)})

    def add(self, made: dict[Definition, FootstepRecords], fell: list[RunFell]) -> None:
        """Add the footsteps and falls of a shard."""
        self.fallen += len(fell)
        for each in fell:
            where = f"run {each.run} ({each.what})"
            self._progress.say(f"{where} fell at {each.time:.2f} s: {each.cause}")
        for definition, records in made.items():
            self._rejected[definition] += Counter(records.rejected)
            self._kept[definition] += len(records.footsteps)

    def counts_of(self, definition: Definition) -> str:
        """Return in words how many footsteps were found by a definition."""
        rejected = self._rejected[definition].most_common()
        refused = ", ".join(f"{count} {why}" for why, count in rejected) or "none"
        return f"{definition}: {self._kept[definition]} footsteps; rejected: {refused}"


_SHOWN = 25
"""Ticks between two updates of the progress."""


def _held(out: Path) -> FolderLock:
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"cannot make the folder {out}: {error.strerror or error}") from error
    return FolderLock(out, "the footstep folder", "give another --out")
