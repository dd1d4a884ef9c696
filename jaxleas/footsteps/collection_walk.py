"""Walks on level ground from which footsteps are collected: commands, variations, falls."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from jaxleas.controllers import FALLS, TICK, UPRIGHT, Controller, Walk, falls
from jaxleas.footsteps.collection_runs import CHANGING, ChangingCommand, CollectionRun
from jaxleas.footsteps.contact_watch import NONE, ContactWatch
from jaxleas.footsteps.samples import SampleLog
from jaxleas.physics import Body, Sensed, Variation, make_physics, standing
from jaxleas.types import ControllerIdentity, InputError


@dataclass(frozen=True)
class CollectionSettings:
    """How footsteps are collected.

    Attributes:
        seconds: time that each run walks [s].
        noise: standard deviation of the noise that is added to each torque, drawn every 4 ms [Nm].
        friction: lowest and highest friction coefficient of the feet, drawn for each run.
        trunk_mass: largest relative change of the trunk's mass, up or down, drawn for each run.
        seed: seed of the random draws.
        at_once: number of robots that walk at once and are written as one shard.
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

    @property
    def ticks(self) -> int:
        """Number of ticks that each run walks."""
        return round(self.seconds / TICK)


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


def walk_runs(
    runs: Sequence[CollectionRun],
    number: int,
    body: Body,
    controller: Controller,
    settings: CollectionSettings,
    tick: Callable[[], None],
) -> tuple[SampleLog, list[RunFell]]:
    """Walk runs at once; return the log of all robots, and who fell.

    Args:
        runs: runs that walk at once.
        number: number of their shard, from which the noise of their torques is drawn.
        body: robot.
        controller: controller that walks it.
        settings: how footsteps are collected.
        tick: function that is called after each tick.
    """
    count, ticks = len(runs), settings.ticks
    drawn = [np.random.default_rng([settings.seed, run.number]) for run in runs]
    low, high = settings.friction
    variation = Variation(
        np.array([rng.uniform(low, high) for rng in drawn]),
        np.array([1.0 + rng.uniform(-1.0, 1.0) * settings.trunk_mass for rng in drawn]),
    )
    commands = _Commands(runs, controller.identity, ticks, drawn)
    walk = Walk(make_physics(body, count, variation=variation), controller, settings.noise)
    start = standing(body, np.zeros((count, 3)))
    walking, log = walk.begin(start), SampleLog(ticks, count, len(body.legs))
    noise = np.random.default_rng([settings.seed, number, _NOISE])
    down, fell = np.zeros(count, dtype=bool), []
    for index in range(ticks):
        command = commands.at(index, walking.sensed)
        walking = walk.tick(walking, command, noise).walking
        log.add(walking.sensed, command)
        causes = falls(body, walking.state, walking.sensed)
        for robot in np.flatnonzero((causes != UPRIGHT) & ~down).tolist():
            run = runs[robot]
            cause = FALLS[causes[robot]]
            fell.append(RunFell(run.number, str(run), (index + 1) * TICK, cause))
        down |= causes != UPRIGHT
        if down.any():  # a fallen robot is put aside: its numbers may diverge
            walking = replace(walking, state=walking.state.replaced(down, start))
        tick()
    return log, fell


class _Commands:
    """Commands of runs that walk at once.

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
