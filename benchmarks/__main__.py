"""Measure how fast jaxleas is on this machine.

python -m benchmarks [--only NAME ...] [--quick] [--runs N] [--json OUT.json | --into FILE.json]
                     [--device gpu] [--config FILE]
"""

import argparse
import os
import sys
from collections.abc import Sequence
from pathlib import Path

from jaxleas.cli_guard import UsageError, run_guarded

BASELINE = Path(__file__).resolve().parent / "baseline.json"
PLATFORMS = ("cpu", "gpu", "tpu")


class _Parser(argparse.ArgumentParser):
    def error(self, message: str):
        raise UsageError(f"{message}; --help lists the options")


def main(arguments: Sequence[str]) -> None:
    """Parse the command line, measure, show, write, compare."""
    given = _parser().parse_args(arguments)
    if given.device:
        # For this process and those that it starts; the host's processor stays available.
        name = {"gpu": "cuda"}.get(given.device, str(given.device))
        os.environ["JAX_PLATFORMS"] = name if name == "cpu" else f"{name},cpu"

    from benchmarks.comparison import by_name, compare
    from benchmarks.context import CONFIG, Context
    from benchmarks.measurements import (
        merge,
        read_measurements,
        this_machine,
        write_measurements,
    )
    from benchmarks.rival import default_python, require_rival
    from benchmarks.suite import choose, measure
    from benchmarks.table import show
    from jaxleas.training import load_run_config, share_cores
    from jaxleas.types import InputError, JaxleasError

    class SlowerError(JaxleasError):
        exit_code = 1

    if given.config and given.check and given.baseline == BASELINE:
        raise UsageError(f"--check --config {given.config}: name its own --baseline FILE")
    metrics = choose(given.only, given.quick)
    if given.list:
        for metric in metrics:
            print(f"{metric.name}  [{metric.unit}], {metric.better} is better")
        return
    config = given.config.resolve() if given.config else CONFIG
    # Mistakes in it are found before anything is measured.
    share_cores(load_run_config(config).ppo)
    _require_device(given.device)
    if given.rivals:
        require_rival(given.rivals)
    target = given.json or given.into
    if target:
        _require_writable(target)
    before = read_measurements(given.into) if given.into and given.into.exists() else []
    # Measurements with another configuration can only be compared with a baseline of their own.
    ours = given.config is None and BASELINE.is_file()
    if given.check or given.baseline != BASELINE or ours:
        baseline = by_name(read_measurements(given.baseline))
    else:
        baseline = {}
    machine = this_machine()
    if any(each.machine != machine for each in before):
        raise InputError(
            f"--into {given.into}: it holds figures of {before[0].machine!r}, and this is"
            f" {machine!r}: one file is of one machine, so give another"
        )
    elsewhere = sorted({each.machine for each in baseline.values()} - {machine})
    if elsewhere and given.check:
        raise InputError(
            f"{given.baseline} was measured on {elsewhere[0]!r}, and this is {machine!r}: measure"
            " a baseline here first, with --json BASELINE.json, and name it with --baseline"
        )
    rivals = None if given.no_rivals else given.rivals or default_python()
    runs = given.runs or (2 if given.quick else 5)
    context = Context(runs, rivals, config)
    measurements = measure(metrics, context, lambda text: print(text, file=sys.stderr, flush=True))
    comparisons = [
        compare(metric, each, baseline) for metric, each in zip(metrics, measurements, strict=True)
    ]
    show(list(zip(measurements, comparisons, strict=True)), machine)
    if elsewhere:
        print(f"The baseline was measured on {elsewhere[0]}: compare with care.")
    if rivals is None:
        print("No rival was measured: see docs/performance.md.")
    if target:
        order = [metric.name for metric in choose([], quick=False)]
        write_measurements(target, merge(measurements, before, order))
    worse = [m.name for m, c in zip(metrics, comparisons, strict=True) if c.verdict == "worse"]
    if worse and given.check:
        raise SlowerError(f"worse than the baseline by more than the tolerance: {', '.join(worse)}")


def _require_writable(path: Path) -> None:
    """Refuse a file that cannot be written before an hour of measuring."""
    from jaxleas.files import write_text

    trial = path.with_name(f"{path.name}.trial")
    write_text(trial, "")
    trial.unlink()


def _require_device(device: str | None) -> None:
    import jax

    from jaxleas.types import InputError

    try:
        # By name: if it is only asked for its devices, JAX silently falls back to the processor.
        jax.devices(device)
    except (AssertionError, RuntimeError) as error:  # jax asserts where a plugin is missing
        raise InputError(
            f"--device {device}: JAX finds no such device here; --device cpu always works"
        ) from error


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(prog="python -m benchmarks", description="Measure how fast jaxleas is here.")
    add = parser.add_argument
    add("--only", nargs="+", default=[], metavar="NAME", help="names or parts of names, as env_")
    add("--list", action="store_true", help="list the metrics instead of measuring")
    add("--quick", action="store_true", help="fewer metrics, two runs")
    add("--runs", type=_positive, metavar="N", help="runs per metric; the median counts (5)")
    files = parser.add_mutually_exclusive_group()
    files.add_argument("--json", type=Path, metavar="OUT.json", help="write the measurements")
    text = "put them into a file, in place of those of the same names: measure piece by piece"
    files.add_argument("--into", type=Path, metavar="FILE.json", help=text)
    add("--baseline", type=Path, default=BASELINE, metavar="FILE", help="baseline to compare with")
    add("--check", action="store_true", help="exit code 1 where worse than the baseline")
    add(
        "--config",
        type=Path,
        metavar="FILE",
        help="configuration instead of the shipped one",
    )
    rivals = parser.add_mutually_exclusive_group()
    add = rivals.add_argument
    add(
        "--rivals",
        nargs="?",
        const=sys.executable,
        metavar="PYTHON",
        help="Python with the rival",
    )
    add("--no-rivals", action="store_true", help="even where this Python has the rival")
    parser.add_argument("--device", choices=PLATFORMS, help="device to measure on (JAX's own)")
    return parser


def _positive(text: str) -> int:
    try:
        value = int(text)
    except ValueError:
        value = 0
    if value < 1:
        raise argparse.ArgumentTypeError(f"{text!r} is not a whole number above zero")
    return value


if __name__ == "__main__":
    sys.argv[0] = "benchmarks"  # as which errors are reported
    sys.exit(run_guarded(lambda: main(sys.argv[1:])))
