"""A sweep from its file to its report."""

import shutil
from collections.abc import Callable
from pathlib import Path

from jaxleas.files import write_text
from jaxleas.sweeps.border import Sweep, open_sweep
from jaxleas.sweeps.conductor import Conductor
from jaxleas.sweeps.folder import open_folder
from jaxleas.sweeps.rehearsal import rehearse_apart
from jaxleas.sweeps.report import report_html
from jaxleas.sweeps.results import TrialResult
from jaxleas.sweeps.runners import engage
from jaxleas.sweeps.storage import require_optuna
from jaxleas.sweeps.study import Study
from jaxleas.types import InputError

REPORT = "report.html"


def run_sweep(
    sweep: Sweep | str | Path,
    out: str | Path,
    *,
    storage: str | None = None,
    workers: str = "processes",
    parallel: int | None = None,
    on_change: Callable[[list[TrialResult], int], None] = lambda results, running: None,
) -> list[TrialResult]:
    """Conduct a sweep to its end; continue it if the folder already holds it.

    Args:
        sweep: sweep, or path of its file.
        out: folder to work in.
        storage: storage of Optuna: grpc://HOST:PORT, a database URL, a journal FILE.log; by default
            a journal in the folder.
        workers: kind of workers: processes, or ray.
        parallel: number of jobs at the same time; by default as in the sweep.
        on_change: function that is called with all results so far and the number of running jobs
            whenever they changed.

    Returns:
        The results of all trials, by number.

    Raises:
        InputError: sweep, task, folder, storage or workers cannot be used.
        OwnCodeError: a method of the user's own task does not keep the protocol.
        InterruptedSweepError: a signal asked to stop; the same call continues.
    """
    require_optuna()
    sweep = sweep if isinstance(sweep, Sweep) else open_sweep(sweep)
    is_new = not Path(out).exists()
    if is_new:
        rehearse_apart(sweep.base, sweep.source, sweep.allow)
    folder = open_folder(Path(out), sweep)
    try:
        try:
            study = Study(sweep, folder, storage)
            count = sweep.config.parallel if parallel is None else parallel
            runner = engage(workers, count, sweep.allow)
        except InputError:
            if is_new:  # leave nothing behind of a sweep that could not begin
                shutil.rmtree(folder.path)
            raise
        results = Conductor(sweep, folder, study, runner, on_change).run()
        page = report_html(sweep, results, study.importance(), folder)
        write_text(folder.path / REPORT, page)
        return results
    finally:
        folder.close()
