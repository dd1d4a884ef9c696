"""Walks of a controller on level ground, from which its footsteps are collected, shard by shard."""

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from jaxleas.controllers import FALLS, TICK, UPRIGHT, Controller, Walk, falls
from jaxleas.footsteps.collection_runs import CHANGING, ChangingCommand, CollectionRun
from jaxleas.footsteps.contact_watch import NONE, ContactWatch
from jaxleas.footsteps.extraction import extract_footsteps
from jaxleas.footsteps.record_file import read_footsteps, write_footsteps
from jaxleas.footsteps.records import Definition, FootstepRecords, join_footsteps
from jaxleas.footsteps.samples import SampleLog
from jaxleas.physics import Body, Sensed, Variation, make_physics, standing
from jaxleas.types import ControllerIdentity, InputError

DEFINITIONS: tuple[Definition, ...] = ("thesis", "contact")


@dataclass(frozen=True)
class CollectionSettings:
    """How footsteps are collected.

    Attributes:
        seconds: time that each run walks [s].
        noise: standard deviation of what is added to each torque, anew every 4 ms [Nm].
        friction: lowest and highest friction coefficient of the feet, drawn for each run.
        trunk_mass: greatest change of the trunk's mass, drawn for each run either way [1].
        seed: seed of all that is drawn.
        at_once: number of robots that walk at once, and are one shard.
    """

    seconds: float = 120.0
    noise: float = 2.0
    friction: tuple[float, float] = (0.5, 1.0)
    trunk_mass: float = 0.1
    seed: int = 0
    at_once: int = 32

    def __post_init__(self) -> None:
        low, high = self.friction
        if not (self.seconds > 0.0 and np.isfinite(self.seconds) and self.noise >= 0.0):
            raise InputError(
                f"runs of {self.seconds:g} s with torque noise of {self.noise:g} Nm: give a"
                " positive time, and no negative noise"
            )
        if not (0.0 < low <= high and 0.0 <= self.trunk_mass < 1.0):
            raise InputError(
                f"friction from {low:g} to {high:g} and trunk masses of +-{self.trunk_mass:g}: give"
                " two positive numbers in ascending order, and a share below 1"
            )
        if self.at_once < 1 or self.seed < 0:
            raise InputError(
                f"{self.at_once} robots at once and seed {self.seed}: give at least one robot, and"
                " no negative seed"
            )


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


@dataclass(frozen=True)
class RunFell:
    """A fall in a run.

    Attributes:
        run: number of the run.
        what: movement and speed of the run, in words.
        time: time of the fall since its beginning [s].
        cause: what showed it, one of `jaxleas.controllers.FALLS`.
    """

    run: int
    what: str
    time: float
    cause: str


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
    log, fell = _walk(shard, body, controller, settings, tick)
    last = {each.run: round(each.time / TICK) for each in fell}
    made: dict[Definition, FootstepRecords] = {}
    for definition in DEFINITIONS:
        found = [
            extract_footsteps(
                log.of(robot, last.get(run.number, _ticks(settings))),
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


def _walk(
    shard: Shard,
    body: Body,
    controller: Controller,
    settings: CollectionSettings,
    tick: Callable[[], None],
) -> tuple[SampleLog, list[RunFell]]:
    """Walk the runs of a shard; return the log of all robots, and who fell."""
    count, ticks = len(shard.runs), _ticks(settings)
    drawn = [np.random.default_rng([settings.seed, run.number]) for run in shard.runs]
    low, high = settings.friction
    variation = Variation(
        np.array([rng.uniform(low, high) for rng in drawn]),
        np.array([1.0 + rng.uniform(-1.0, 1.0) * settings.trunk_mass for rng in drawn]),
    )
    commands = _Commands(shard.runs, controller.identity, ticks, drawn)
    walk = Walk(make_physics(body, count, variation=variation), controller, settings.noise)
    start = standing(body, np.zeros((count, 3)))
    walking, log = walk.begin(start), SampleLog(ticks, count, len(body.legs))
    noise = np.random.default_rng([settings.seed, shard.number, _NOISE])
    down, fell = np.zeros(count, dtype=bool), []
    for index in range(ticks):
        command = commands.at(index, walking.sensed)
        walking = walk.tick(walking, command, noise).walking
        log.add(walking.sensed, command)
        causes = falls(body, walking.state, walking.sensed)
        for robot in np.flatnonzero((causes != UPRIGHT) & ~down):
            run = shard.runs[robot]
            cause = FALLS[causes[robot]]
            fell.append(RunFell(run.number, str(run), (index + 1) * TICK, cause))
        down |= causes != UPRIGHT
        if down.any():  # whoever lies on the ground is put aside: its numbers may diverge
            walking = replace(walking, state=walking.state.replaced(down, start))
        tick()
    return log, fell


class _Commands:
    """Commands of the runs of a shard.

    Args:
        runs: runs that walk at once.
        controller: identity of the controller that walks.
        ticks: number of ticks.
        drawn: source of each run's draws.
    """

    def __init__(
        self,
        runs: Sequence[CollectionRun],
        controller: ControllerIdentity,
        ticks: int,
        drawn: Sequence[np.random.Generator],
    ) -> None:
        self._watch = ContactWatch(controller, len(runs))
        times = TICK * np.arange(ticks)
        self._planned = np.zeros((ticks, len(runs), 3))
        self._changing: dict[int, ChangingCommand] = {}
        for robot, (run, rng) in enumerate(zip(runs, drawn, strict=True)):
            if run.movement == CHANGING:
                self._changing[robot] = ChangingCommand(controller, rng)
            else:
                self._planned[:, robot] = run.commands(controller, times, rng)

    def at(self, tick: int, sensed: Sensed) -> np.ndarray:
        """Return the commands during a tick.

        Args:
            tick: number of the tick; each is asked for once, in order.
            sensed: measurements before it.
        """
        command, ended = self._planned[tick], self._watch.update(sensed)
        for robot, changing in self._changing.items():
            if ended[robot] != NONE:
                changing.footstep_ended()
            command[robot] = changing.now
        return command


_NOISE = 1
"""Sets the seed of the noise apart from those of the runs, which have two numbers."""


def _ticks(settings: CollectionSettings) -> int:
    return round(settings.seconds / TICK)


def _settings(shard: Shard, settings: CollectionSettings) -> dict[str, Any]:
    """Return the settings as they are recorded, with the runs of the shard."""
    runs = [f"{run.number}: {run}" for run in shard.runs]
    return {**asdict(settings), "friction": list(settings.friction), "runs": runs}


def _difference(found: Any, wanted: dict[str, Any]) -> str:
    if not isinstance(found, dict):
        return "its settings are not stated"
    other = [key for key in wanted if found.get(key) != wanted[key]]
    return f"with other {' and '.join(other)}"
