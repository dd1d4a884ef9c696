"""Draw the cost of growth: speed and memory against robots, observation, arenas and networks.

python -m benchmarks.growth BENCHMARKS.json --out PICTURE.png
"""

import argparse
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from benchmarks.measurements import Measurement, read_measurements
from benchmarks.workloads.environment import ARENA_ROBOTS
from benchmarks.workloads.environment import ARENAS as ENV_ARENAS
from benchmarks.workloads.environment import SIZES as ENV_SIZES
from benchmarks.workloads.training import ARENAS, AS_SHIPPED, SIZES, WIDTHS, memory_name
from jaxleas.cli_guard import UsageError, run_guarded
from jaxleas.envs.steering import ICRA81, THESIS144
from jaxleas.files import atomic_path
from jaxleas.training import run_config_of
from jaxleas.types import InputError

SHIPPED = run_config_of("steering")()
ENV_SHIPPED = f"env_{THESIS144.name}_{ARENA_ROBOTS}"
ENVIRONMENT_COLOUR, TRAINING_COLOUR = "#1f5fd0", "#e07020"


@dataclass(frozen=True)
class Axis:
    """One quantity that grows.

    Attributes:
        label: name of the quantity.
        training: metric of training for each value.
        environment: metric of the environment alone for each value; empty if it has no effect.
    """

    label: str
    training: dict[int, str]
    environment: dict[int, str]


AXES = (
    Axis(
        "robots",
        {each: f"ppo_{each}" for each in SIZES} | {SHIPPED.ppo.environments: AS_SHIPPED},
        {each: f"env_{THESIS144.name}_{each}" for each in ENV_SIZES},
    ),
    Axis(
        "values observed",
        {ICRA81.size: "ppo_icra81", THESIS144.size: AS_SHIPPED},
        {each.size: f"env_{each.name}_{ARENA_ROBOTS}" for each in (ICRA81, THESIS144)},
    ),
    Axis(
        "arenas",
        {each: f"ppo_arenas_{each}" for each in ARENAS} | {SHIPPED.terrain.arenas: AS_SHIPPED},
        {each: f"env_arenas_{each}" for each in ENV_ARENAS} | {SHIPPED.terrain.arenas: ENV_SHIPPED},
    ),
    Axis(
        "first hidden layer",
        {each: f"ppo_width_{each}" for each in WIDTHS} | {SHIPPED.network.hidden[0]: AS_SHIPPED},
        {},
    ),
)


def draw_growth(measurements: Sequence[Measurement], out: str | Path) -> None:
    """Draw one column for each quantity that grows: speed above, memory below.

    Args:
        measurements: measurements, with all that `AXES` names.
        out: file of the picture.

    Raises:
        InputError: a measurement is missing.
    """
    from matplotlib.figure import Figure

    values = {each.name: each.value for each in measurements if each.value is not None}
    needed = [
        name for axis in AXES for name in (*axis.training.values(), *axis.environment.values())
    ]
    needed += [memory_name(name) for axis in AXES for name in axis.training.values()]
    missing = sorted(set(needed) - values.keys())
    if missing:
        raise InputError(
            f"{len(missing)} of the {len(set(needed))} figures to be drawn are missing, as"
            f" {missing[0]}: measure them with  --only {' '.join(missing[:4])} ..."
        )
    figure = Figure(figsize=(12.0, 5.2), layout="constrained")
    grid = figure.subplots(2, len(AXES), sharex="col", sharey="row")
    for axis, (above, below) in zip(AXES, grid.T, strict=True):
        for names, colour in (
            (axis.environment, ENVIRONMENT_COLOUR),
            (axis.training, TRAINING_COLOUR),
        ):
            _line(above, {x: values[name] for x, name in names.items()}, colour)
        memory = {x: values[memory_name(name)] for x, name in axis.training.items()}
        _line(below, memory, TRAINING_COLOUR)
        ticks = sorted({*axis.training, *axis.environment})
        below.set_xscale("log", base=2)
        below.set_xticks(ticks, [f"{each:,}" for each in ticks], rotation=45)
        below.set_xticks([], minor=True)
        below.set_xlabel(axis.label)
    for plots, label in zip(grid, ("steps/s", "memory of the train step [MiB]"), strict=True):
        plots[0].set_yscale("log")
        plots[0].set_ylabel(label)
    grid[0][0].plot([], [], "o-", color=ENVIRONMENT_COLOUR, label="environment alone")
    grid[0][0].plot([], [], "o-", color=TRAINING_COLOUR, label="training")
    grid[0][0].legend(fontsize="small")
    figure.suptitle(f"The cost of growth, all else as shipped: {measurements[0].machine}")
    with atomic_path(out) as temporary:
        figure.savefig(temporary, dpi=110)


def _line(plot, points: dict[int, float], colour: str) -> None:
    xs = sorted(points)
    plot.plot(xs, [points[x] for x in xs], "o-", color=colour)
    plot.grid(True, alpha=0.3)


class _Parser(argparse.ArgumentParser):
    def error(self, message: str):
        raise UsageError(f"{message}; --help shows how")


def main(arguments: Sequence[str]) -> None:
    """Read a benchmark file and draw it."""
    parser = _Parser(prog="python -m benchmarks.growth", description=__doc__)
    parser.add_argument("benchmarks", type=Path)
    parser.add_argument("--out", type=Path, required=True, metavar="PICTURE.png")
    given = parser.parse_args(arguments)
    if given.out.suffix not in (".png", ".svg"):
        raise UsageError(f"--out {given.out}: a picture ends in .png or .svg")
    draw_growth(read_measurements(given.benchmarks), given.out)


if __name__ == "__main__":
    sys.argv[0] = "growth"  # as which errors are reported
    sys.exit(run_guarded(lambda: main(sys.argv[1:])))
