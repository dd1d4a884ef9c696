"""The function behind `jaxleas train`: compose the rooms that train, judge, export and report."""

import sys
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from jaxleas.cli_guard import UsageError
from jaxleas.configuration import Allow
from jaxleas.runs import interrupts_deferred

# JAX takes a second to import: not before the command line is parsed.
if TYPE_CHECKING:
    from jaxleas.envs import Task
    from jaxleas.runs import RunFolder
    from jaxleas.training import Devices, RunConfig


class _DeviceCount:
    """What the option --devices takes."""

    def parse(self, text: str) -> int | Literal["all"]:
        """Return a value given on the command line."""
        if text == "all":
            return "all"
        if not (text.isdecimal() and int(text) > 0):
            raise UsageError(f"--devices is {text!r}, but it should be all or a number of devices")
        return int(text)


@dataclass(frozen=True)
class _Given:
    """What the command line states."""

    config: Path | None
    overrides: Sequence[str]
    run_dir: Path | None
    resume: Path | None
    devices: int | Literal["all"]
    coordinator: str | None
    process: str | None
    allow: Sequence[str]


def train(
    config: Path | None = None,
    *overrides: str,
    run_dir: Path | None = None,
    resume: Path | None = None,
    devices: Annotated[int | Literal["all"], _DeviceCount()] = "all",
    coordinator: str | None = None,
    process: str | None = None,
    allow: Allow = (),
) -> None:
    """Train a policy, judge it, export it and write its report.

    Args:
        config: YAML file of the configuration, or the name of one that comes with jaxleas, such as
            leas_p1. Every field of it is an option, too, such as --ppo.discount 0.97; CONFIG --help
            lists them.
        overrides: further options, which override fields of the configuration.
        run_dir: folder for the run; by default runs/CONFIG_DATE_TIME.
        resume: run folder of an interrupted training, which is continued exactly as configured.
        devices: number of devices that share the training, or all; each CPU core is one.
        coordinator: address of process 0, HOST:PORT, where several processes train together; auto:
            as the cluster states it.
        process: number of this process and of all that train together, I/N.
        allow: your own code that the configuration names: a task, a condition.

    Raises:
        UsageError: neither a configuration nor a run to resume is given, or both are.
    """
    if (config is None) == (resume is None):
        raise UsageError(
            "give a configuration, such as leas_p1 or a YAML file's path, or --resume RUN"
        )
    if resume and (overrides or run_dir):
        surplus = overrides or ["--run-dir"]
        raise UsageError(f"--resume continues exactly as configured: leave out {' '.join(surplus)}")
    given = _Given(config, overrides, run_dir, resume, devices, coordinator, process, allow)
    if coordinator is None and process is None:
        settled, task, shared, run = _open(given)
        with run:
            _train(settled, task, shared, run)
            _conclude(settled, run, allow)
    else:
        _train_together(given)


def _train_together(given: _Given) -> None:
    """Train with other processes: process 0 opens the run and sends its configuration."""
    from jaxleas.files import parse_json
    from jaxleas.training import choose_devices, connect, disconnect, from_first, parse_run_config

    opened = []

    def open_run() -> str:
        opened.append(_open(given))
        return opened[0][0].model_dump_json()

    connect(given.coordinator, given.process)
    source = "process 0's configuration"
    config = parse_run_config(parse_json(from_first(open_run), source), source, given.allow)
    if not opened:
        _assist(config, choose_devices(given.devices, config.ppo), given.allow)
        disconnect()
        return
    _, task, devices, run = opened[0]
    with run:
        _train(config, task, devices, run)
        disconnect()
        _conclude(config, run, given.allow)


def _open(given: _Given) -> "tuple[RunConfig, Task, Devices, RunFolder]":
    with interrupts_deferred():
        from jaxleas.configuration import to_yaml
        from jaxleas.runs import RunFolder, require_watchers
        from jaxleas.training import load_run_config, make_task, pinned, rehearse

    if given.resume:
        found = RunFolder.open(given.resume, needs_checkpoint=False)
        config = load_run_config(found.config, allow=given.allow)
        devices = _devices(given, config)  # before anything touches JAX's devices
        task = make_task(config, given.allow)  # before the folder is held: it may not be allowed
        rehearse(config, task)
        run = RunFolder.open(given.resume, writing=True, needs_checkpoint=False)
        return config, task, devices, run
    assert given.config is not None  # `train` has seen to it
    config = pinned(load_run_config(given.config, given.overrides, given.allow))
    require_watchers(config.watch)  # before a folder is made
    devices = _devices(given, config)
    task = make_task(config, given.allow)
    task.require_worlds()  # likewise
    rehearse(config, task)
    program, *words = sys.argv
    name = f"runs/{given.config.stem}_{datetime.now():%Y-%m-%d_%H-%M-%S}"
    run = RunFolder.create(given.run_dir or name, to_yaml(config), [Path(program).name, *words])
    return config, task, devices, run


def _devices(given: _Given, config: "RunConfig") -> "Devices":
    from jaxleas.training import choose_devices, share_cores

    if given.coordinator is None:  # several processes share the cores among themselves
        share_cores(config.ppo)
    return choose_devices(given.devices, config.ppo)


def _train(config: "RunConfig", task: "Task", devices: "Devices", run: "RunFolder") -> None:
    from jaxleas.training import train_task
    from jaxleas.xla import keep_compiled_programs

    keep_compiled_programs()
    train_task(config, task, run, devices)


def _assist(config: "RunConfig", devices: "Devices", allow: Sequence[str]) -> None:
    from jaxleas.training import assist
    from jaxleas.xla import keep_compiled_programs

    keep_compiled_programs()
    assist(config, devices, allow)


def _conclude(config: "RunConfig", run: "RunFolder", allow: Sequence[str]) -> None:
    if not config.final.evaluate:
        return
    from jaxleas.evaluation import SUITED_TASKS
    from jaxleas.export import export

    if config.env.task not in SUITED_TASKS:  # judged by its own examination alone
        export(run.path, allow=tuple(allow))
        return
    from jaxleas.reports import evaluate, report

    evaluate(run.path, starts=config.final.starts)  # by R* and C, as every run
    export(run.path, allow=tuple(allow))
    report(run.path)
