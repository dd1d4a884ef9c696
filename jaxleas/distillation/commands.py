"""The functions behind `jaxleas distill` and `jaxleas report`."""

from pathlib import Path

from jaxleas.configuration import Allow
from jaxleas.types import InputError


def distill(
    config: Path,
    *,
    out: Path,
    start: Path | None = None,
    planner: str | None = None,
    processes: int | None = None,
    devices: int | None = None,
    allow: Allow = (),
) -> None:
    """Refine a policy and a surrogate in turn, judged by the exact contact planner.

    Args:
        config: configuration of the distillation, YAML.
        out: folder to work in; the same command resumes where it was interrupted.
        start: run folder of the policy to begin with; by default one is trained first.
        planner: name of the configuration's planner, repeated here to permit one of your own, as
            --allow does.
        processes: number of processes that ask the planner; all cores by default.
        devices: number of devices that share the practice; all by default; each CPU core is one.
        allow: your own code that the configuration, or the run to begin with, names: a planner, a
            condition.
    """
    import os

    from jaxleas.contacts import permit
    from jaxleas.distillation.distill import run_rounds
    from jaxleas.distillation.folder import DistillationFolder
    from jaxleas.distillation.loading import first_run, load_distillation
    from jaxleas.distillation.opening import open_folder, train_start
    from jaxleas.distillation.table import table_of
    from jaxleas.distillation.workplace import Workplace
    from jaxleas.files import FolderLock
    from jaxleas.training import choose_devices, share_cores
    from jaxleas.xla import keep_compiled_programs

    if processes is not None and processes < 1:
        raise InputError(f"--processes is {processes}; give 1 or more")
    if devices is not None and devices < 1:
        raise InputError(f"--devices is {devices}; give 1 or more")
    keep_compiled_programs()
    folder = DistillationFolder(Path(out))
    asked = load_distillation(config, start)
    permitted = permit(config, asked.planner, planner, allow)
    ppo = first_run(asked, start).ppo
    if asked.mode == "surrogate":
        share_cores(ppo)
    sharing = choose_devices(devices or "all", ppo)
    settled = open_folder(folder, asked, start, permitted)
    with FolderLock(folder.path, "the distillation", "give another --out"):
        run = train_start(folder, settled, sharing, permitted)
        count = processes or os.cpu_count() or 1
        place = Workplace(settled, folder, str(run), count, sharing, permitted)
        results = run_rounds(place, _Teller())
    print(table_of(results))
    beside = f"; {folder.surrogate}: its surrogate" if settled.mode == "surrogate" else ""
    print(f"{folder.policy}: the best round's policy{beside}")


def report(run: Path, out: Path | None = None, allow: Allow = ()) -> Path:
    """Write a run's report as one self-contained HTML file.

    For a training: suites that the run was not yet judged on are judged first. For a distillation:
    what its files hold; the report says what is missing, and which command makes it.

    Args:
        run: a run folder, or a distillation's folder.
        out: file to write; by default RUN/report.html.
        allow: planner of your own that a distillation used, so that the report gives its title. The
            policy of a training is judged by R* and C, whatever its own conditions.

    Raises:
        InputError: the path is not such a folder, or holds no policy, or no round, yet.
    """
    from jaxleas.distillation.report_data import is_distilled

    if not is_distilled(Path(run)):
        from jaxleas.reports import report as report_training

        return report_training(run, out)
    from jaxleas.distillation.report import write_distilled_report

    path = write_distilled_report(Path(run), out, allow)
    print(f"written: {path}")
    return path


class _Teller:
    """Shows every stage, and its progress every few seconds."""

    PAUSE = 5.0  # [s]

    def __init__(self) -> None:
        self.last = float("-inf")

    def __call__(self, words: str, *, passing: bool = False) -> None:
        from time import monotonic

        if passing and monotonic() - self.last < self.PAUSE:
            return
        self.last = monotonic()
        print(words, flush=True)
