"""Train a policy, judge it, export it and write its report.

python train.py configs/leas_p1.yaml [--run-dir DIR] [--any.field VALUE ...]
python train.py --resume RUN

Either with [--devices all|N], with [--allow MODULE:CLASS ...] for each piece of code of your own
that the configuration names (a task, a condition), and with [--coordinator HOST:PORT
--process I/N] or [--coordinator auto] for each of several processes that train together.
"""

import argparse
import sys
from collections.abc import Sequence
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from jaxleas.cli_guard import UsageError, run_guarded
from jaxleas.configuration import require_own_name
from jaxleas.runs import interrupts_deferred

# JAX takes a second to import: not before the command line is parsed.
if TYPE_CHECKING:
    from jaxleas.envs import Task
    from jaxleas.runs import RunFolder
    from jaxleas.training import Devices, RunConfig


def main(arguments: Sequence[str]) -> None:
    """Parse the command line, compose the rooms, run."""
    given, overrides = _parser().parse_known_args(arguments)
    if not arguments or (given.config is None and given.resume is None and "--help" in overrides):
        print(__doc__)
        return
    if (given.config is None) == (given.resume is None):
        raise UsageError("give a configuration, as configs/leas_p1.yaml, or --resume RUN: one")
    if given.resume and (overrides or given.run_dir):
        surplus = overrides or ["--run-dir"]
        raise UsageError(f"--resume continues exactly as configured: leave out {' '.join(surplus)}")
    if given.coordinator is None and given.process is None:
        config, task, devices, run = _open(given, overrides, arguments)
        with run:
            _train(config, task, devices, run)
            _conclude(config, run, given.allow)
    else:
        _train_together(given, overrides, arguments)


def _train_together(
    given: argparse.Namespace, overrides: Sequence[str], arguments: Sequence[str]
) -> None:
    """Train with other processes: process 0 opens the run and sends its configuration."""
    from jaxleas.files import parse_json
    from jaxleas.training import choose_devices, connect, disconnect, from_first, parse_run_config

    opened = []

    def open_run() -> str:
        opened.append(_open(given, overrides, arguments))
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


def _open(
    given: argparse.Namespace, overrides: Sequence[str], arguments: Sequence[str]
) -> "tuple[RunConfig, Task, Devices, RunFolder]":
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
    config = pinned(load_run_config(given.config, overrides, given.allow))
    require_watchers(config.watch)  # before a folder is made
    devices = _devices(given, config)
    task = make_task(config, given.allow)
    task.require_worlds()  # likewise
    rehearse(config, task)
    name = f"runs/{Path(given.config).stem}_{datetime.now():%Y-%m-%d_%H-%M-%S}"
    run = RunFolder.create(given.run_dir or name, to_yaml(config), ["train.py", *arguments])
    return config, task, devices, run


def _devices(given: argparse.Namespace, config: "RunConfig") -> "Devices":
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


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(add_help=False, allow_abbrev=False)
    parser.add_argument("config", nargs="?")
    parser.add_argument("--run-dir")
    parser.add_argument("--resume", metavar="RUN")
    parser.add_argument(
        "--allow", action="append", default=[], type=require_own_name, metavar="MODULE:CLASS"
    )
    parser.add_argument("--devices", type=_device_count, default="all", metavar="all|N")
    parser.add_argument("--coordinator", metavar="HOST:PORT")
    parser.add_argument("--process", metavar="I/N")
    return parser


def _device_count(text: str) -> int | Literal["all"]:
    if text == "all":
        return "all"
    if not (text.isdecimal() and int(text) > 0):
        raise UsageError(f"--devices is {text!r}, but it should be all or a number of devices")
    return int(text)


if __name__ == "__main__":
    sys.exit(run_guarded(lambda: main(sys.argv[1:])))
