"""Collections of footsteps: runs of a controller, walked and written shard by shard."""

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from jaxleas.controllers import TICK, Controller
from jaxleas.footsteps.collection_runs import CollectionRun
from jaxleas.footsteps.collection_walk import CollectionSettings, RunFell, walk_runs
from jaxleas.footsteps.extraction import extract_footsteps
from jaxleas.footsteps.record_file import read_footsteps, write_footsteps
from jaxleas.footsteps.records import Definition, FootstepRecords, join_footsteps
from jaxleas.physics import Body
from jaxleas.types import InputError

DEFINITIONS: tuple[Definition, ...] = ("thesis", "contact")


@dataclass(frozen=True)
class Shard:
    """Runs that walk at once.

    Attributes:
        number: number of the shard.
        runs: its runs.
        out: folder of the collection.
    """

    number: int
    runs: tuple[CollectionRun, ...]
    out: Path

    def file(self, definition: Definition) -> Path:
        """Return the file of the footsteps by one definition."""
        return self.out / definition / f"footsteps_{self.number:03}.npz"


def plan_shards(runs: Sequence[CollectionRun], at_once: int, out: Path) -> list[Shard]:
    """Return the shards of a collection.

    Runs are dealt out in turn, so that each shard holds all movements.
    """
    count = -(-len(runs) // at_once)
    return [Shard(number, tuple(runs[number::count]), out) for number in range(count)]


def is_done(shard: Shard, controller: Controller, settings: CollectionSettings) -> bool:
    """Return whether a shard's files are there.

    Raises:
        InputError: they hold footsteps of another controller, or collected in another way.
    """
    files = [shard.file(each) for each in DEFINITIONS]
    if not all(file.exists() for file in files):
        return False
    for file in files:
        records = read_footsteps(file)
        controller.identity.require_same(records.controller, str(file), "the command")
        found, wanted = records.collection.get("settings"), _settings(shard, settings)
        if found != wanted:
            raise InputError(
                f"{file} holds footsteps collected in another way: {_difference(found, wanted)};"
                " give another --out, or remove that folder"
            )
    return True


def collect_shard(
    shard: Shard,
    body: Body,
    controller: Controller,
    settings: CollectionSettings,
    provenance: dict[str, Any],
    tick: Callable[[], None],
) -> tuple[dict[Definition, FootstepRecords], list[RunFell]]:
    """Walk the runs of a shard, write its files, and return footsteps and falls.

    Args:
        shard: runs that walk at once.
        body: robot.
        controller: controller that walks it.
        settings: how footsteps are collected.
        provenance: versions, command and machine.
        tick: function that is called after each tick.
    """
    log, fell = walk_runs(shard.runs, shard.number, body, controller, settings, tick)
    last = {each.run: round(each.time / TICK) for each in fell}
    made: dict[Definition, FootstepRecords] = {}
    for definition in DEFINITIONS:
        found = [
            extract_footsteps(
                log.of(robot, last.get(run.number, settings.ticks)),
                *(run.number, controller.identity, definition),
            )
            for robot, run in enumerate(shard.runs)
        ]
        collection = {"settings": _settings(shard, settings), "falls": [asdict(e) for e in fell]}
        made[definition] = FootstepRecords(
            join_footsteps([each.footsteps for each in found]),
            *(controller.identity, definition),
            *(dict(sum((each.rejected for each in found), Counter())), collection, provenance),
        )
        shard.file(definition).parent.mkdir(parents=True, exist_ok=True)
        write_footsteps(shard.file(definition), made[definition])
    return made, fell


def _settings(shard: Shard, settings: CollectionSettings) -> dict[str, Any]:
    """Return the settings as they are recorded, with the runs of the shard."""
    runs = [f"{run.number}: {run}" for run in shard.runs]
    return {**asdict(settings), "friction": list(settings.friction), "runs": runs}


def _difference(found: Any, wanted: dict[str, Any]) -> str:
    if not isinstance(found, dict):
        return "its settings are not stated"
    other = [key for key in wanted if found.get(key) != wanted[key]]
    return f"with other {' and '.join(other)}"
