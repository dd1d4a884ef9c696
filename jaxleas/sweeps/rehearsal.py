"""A sweep's rehearsal: its task is made and tried before the sweep leaves anything behind."""

from collections.abc import Collection

from jaxleas.files import parse_json
from jaxleas.training import AnyRun, make_task, parse_run_config, rehearse
from jaxleas.workers import ProcessWorkers


def rehearse_apart(config: AnyRun, source: str, allow: Collection[str] = ()) -> None:
    """Rehearse a run's task in a process of its own: this one must hold no device of JAX.

    Args:
        config: configuration of the run.
        source: name of the file that states it, with which error messages begin.
        allow: user's own code that may be run, as MODULE:CLASS.

    Raises:
        InputError: the task, or a condition that it names, cannot be made.
        OwnCodeError: a method of the user's own task does not keep the protocol (`rehearse`).
    """
    workers = ProcessWorkers(1)
    try:
        list(workers.run(_rehearse, [(config.model_dump_json(), source, tuple(allow))]))
    finally:
        workers.close()


def _rehearse(task: tuple[str, str, tuple[str, ...]]) -> None:
    plain, source, allow = task
    config = parse_run_config(parse_json(plain, source), source, allow)
    rehearse(config, make_task(config, allow))
