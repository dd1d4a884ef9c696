"""The function behind `jaxleas gait imitate`."""

from pathlib import Path

from jaxleas.envs.gait_planning import GaitPlanning
from jaxleas.gaits.demonstrations import collect
from jaxleas.gaits.imitation import imitate as fit
from jaxleas.runs import POLICY_FILE, Progress
from jaxleas.training import load_run_config, make_task, write_policy
from jaxleas.types import InputError

FIRST_SEED = 300_000
"""Seed of the first field that demonstrations come from: training may use the same fields,
examinations never do."""


def imitate(
    config: Path,
    *overrides: str,
    out: Path,
    starts: int = 2400,
    passes: int = 25,
) -> None:
    """Teach a gait policy to do as the search does: a training of the configuration begins with it.

    Args:
        config: YAML file of the configuration, or the name of one that comes with jaxleas, such as
            gaits.
        overrides: further options, which override fields of the configuration, such as
            --env.snap 0.09.
        out: folder for the policy (policy.npz) and the demonstrations, which are kept when this is
            interrupted.
        starts: number of starts to search from.
        passes: number of passes over the demonstrations.
    """
    for name, value in (("--starts", starts), ("--passes", passes)):
        if value < 1:
            raise InputError(f"{name} {value}: give 1 or more")
    run = load_run_config(config, overrides)
    task = make_task(run)
    if not isinstance(task, GaitPlanning):
        raise InputError(f"{config}: env.task is {run.env.task}: only gait_planning is imitated")
    with Progress(starts, unit="starts") as progress:
        shown = collect(
            task,
            out / "demonstrations",
            starts,
            FIRST_SEED,
            lambda done, rows: progress.update(done, {"transitions": f"{rows:,}"}),
        )
    with Progress(passes, unit="passes") as progress:
        policy = fit(
            run,
            task,
            shown,
            passes,
            lambda done, loss: progress.update(done, {"loss": f"{loss:.3f}"}),
        )
    write_policy(out / POLICY_FILE, policy)
    print(
        f"{len(shown):,} transitions imitated; written to {out / POLICY_FILE}; train on with"
        f"  jaxleas train {config} --begin {out / POLICY_FILE}"
    )
