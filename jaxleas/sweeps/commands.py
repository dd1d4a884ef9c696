"""The commands `jaxleas sweep` and `jaxleas population`."""

from pathlib import Path
from typing import Literal

from jaxleas.configuration import Allow


def sweep(
    sweep: Path,
    *,
    out: Path,
    storage: str | None = None,
    workers: Literal["processes", "ray"] = "processes",
    parallel: int | None = None,
    allow: Allow = (),
) -> None:
    """Search a space of configurations; the same command continues an interrupted search.

    Args:
        sweep: YAML file of the search.
        out: folder to work in.
        storage: grpc://HOST:PORT, a database URL or FILE.log; by default a journal in the folder.
        workers: processes on this machine, or ray: the cluster that RAY_ADDRESS names.
        parallel: number of trainings that run at the same time; by default as in the file.
        allow: your own code that the configuration names.
    """
    from jaxleas.sweeps.border import open_sweep
    from jaxleas.sweeps.progress import SweepProgress
    from jaxleas.sweeps.results import plain_table
    from jaxleas.sweeps.sweep import REPORT, run_sweep

    opened = open_sweep(sweep, allow)
    progress = SweepProgress(opened)
    try:
        results = run_sweep(
            opened,
            out,
            storage=storage,
            workers=workers,
            parallel=parallel,
            on_change=progress,
        )
    finally:
        progress.close()
    print(plain_table(results, opened))
    print(f"written: {Path(out) / REPORT}, results.csv and results.json beside it")


def population(population: Path, *, out: Path, allow: Allow = ()) -> None:
    """Train several policies in one compiled program; the same command continues it.

    Args:
        population: YAML file of the members.
        out: folder to work in; each member's run folder is OUT/member_NN.
        allow: your own code that the configuration names.
    """
    import sys

    from jaxleas.sweeps.devices import use_all_cores
    from jaxleas.sweeps.population_config import open_population
    from jaxleas.sweeps.population_folder import hold_population
    from jaxleas.sweeps.population_loop import train_population
    from jaxleas.sweeps.population_table import population_table
    from jaxleas.training import make_task, rehearse
    from jaxleas.xla import keep_compiled_programs

    members = open_population(population, allow)
    use_all_cores()
    keep_compiled_programs()
    rehearse(members.configs[0], make_task(members.configs[0], allow))
    with hold_population(Path(out), members) as runs:
        results = train_population(members, runs, Path(out), ["jaxleas", *sys.argv[1:]])
    print(population_table(members, results))
