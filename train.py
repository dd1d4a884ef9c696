"""Train a steering policy, judge it, export it and write its report.

python train.py configs/leas_p1.yaml [--run-dir DIR] [--any.field VALUE ...]
python train.py --resume RUN
"""

import argparse
import sys
from collections.abc import Sequence
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING

from jaxleas.cli_guard import UsageError, run_guarded

# JAX takes a second to import: not before the command line has been understood.
if TYPE_CHECKING:
    from jaxleas.training.config import RunConfig
    from jaxleas.training.run_folder import RunFolder


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
        raise UsageError(f"--resume goes on exactly as configured: leave out {' '.join(surplus)}")
    config, run = _go_on(given.resume) if given.resume else _begin(given, overrides, arguments)
    with run:
        _run(config, run)


def _go_on(folder: str) -> "tuple[RunConfig, RunFolder]":
    from jaxleas.training.config import RunConfig
    from jaxleas.training.configuration import load_config
    from jaxleas.training.run_folder import RunFolder

    run = RunFolder.open(folder, writing=True, needs_checkpoint=False)
    return load_config(RunConfig, run.config), run


def _begin(
    given: argparse.Namespace, overrides: Sequence[str], arguments: Sequence[str]
) -> "tuple[RunConfig, RunFolder]":
    from jaxleas.training.config import RunConfig
    from jaxleas.training.configuration import load_config, to_yaml
    from jaxleas.training.run_folder import RunFolder

    config = load_config(RunConfig, given.config, overrides)
    name = f"runs/{Path(given.config).stem}_{datetime.now():%Y-%m-%d_%H-%M-%S}"
    run = RunFolder.create(given.run_dir or name, to_yaml(config), ["train.py", *arguments])
    return config, run


def _run(config: "RunConfig", run: "RunFolder") -> None:
    from jaxleas.evaluation.commands import evaluate, report
    from jaxleas.export.commands import export
    from jaxleas.training.compilation import keep_compiled_programs
    from jaxleas.training.loop import train

    keep_compiled_programs()
    train(config, run)
    if config.final.evaluate:
        evaluate(run.path, starts=config.final.starts)
        export(run.path)
        report(run.path)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(add_help=False, allow_abbrev=False)
    parser.add_argument("config", nargs="?")
    parser.add_argument("--run-dir")
    parser.add_argument("--resume", metavar="RUN")
    return parser


if __name__ == "__main__":
    sys.exit(run_guarded(lambda: main(sys.argv[1:])))
