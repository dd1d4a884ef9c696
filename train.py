"""Train a steering policy, judge it, export it and write its report.

python train.py configs/leas_p1.yaml [--run-dir DIR] [--any.field VALUE ...]
python train.py --resume RUN
"""

import argparse
import sys
from collections.abc import Sequence
from datetime import datetime
from pathlib import Path

from jaxleas.cli_guard import UsageError, run_guarded


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

    from jaxleas.training.config import RunConfig
    from jaxleas.training.configuration import load_config, to_yaml
    from jaxleas.training.run_folder import RunFolder

    if given.resume:
        run = RunFolder.open(given.resume, writing=True, needs_checkpoint=False)
        config = load_config(RunConfig, run.config)
    else:
        config = load_config(RunConfig, given.config, overrides)
        name = f"runs/{Path(given.config).stem}_{datetime.now():%Y-%m-%d_%H-%M-%S}"
        run = RunFolder.create(given.run_dir or name, to_yaml(config), ["train.py", *arguments])
    with run:
        _run(config, run)


def _run(config, run) -> None:
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
