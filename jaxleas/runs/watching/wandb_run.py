"""Weights & Biases; set up by its own variables (WANDB_PROJECT, WANDB_MODE=offline, ...)."""

from collections.abc import Mapping
from importlib import import_module
from pathlib import Path
from typing import Any
from uuid import uuid4

from jaxleas.runs.watching.identity import lasting_identity
from jaxleas.runs.watching.watcher import Status
from jaxleas.types import InputError

PROJECT = "jaxleas"
"""Name of the project if WANDB_PROJECT is not set."""
PATIENCE = 25.0
"""Time for the server to answer [s]; less than the audience's farewell, so no process hangs."""
EXIT_CODES: dict[Status, int] = {"finished": 0, "interrupted": 130, "failed": 1}


def require_usable(wandb: Any) -> None:
    """Refuse a client that would ask for a key during the run.

    Raises:
        InputError: the client is online and has no key.
    """
    settings = wandb.setup().settings
    if settings.mode != "online" or settings.api_key:
        return
    if not wandb.login(prompt=False, verify=False):
        raise InputError("watch: wandb knows no key: run `wandb login`, or set WANDB_MODE=offline")


class WandbWatcher:
    """A run of Weights & Biases; a resumed training continues it.

    Args:
        folder: run folder, which holds the identity in `wandb.json`, and the client's own files in
            `wandb/`.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder

    def begin(self, config: Mapping[str, Any], name: str, resumed_after: int | None) -> None:
        """Open the run; the client skips rows that it already has."""
        wandb: Any = import_module("wandb")
        project = wandb.setup().settings.project
        self._run = wandb.init(
            project=project or PROJECT,
            id=lasting_identity(self._folder / "wandb.json", lambda: uuid4().hex[:16]),
            resume="allow",
            name=name,
            dir=str(self._folder),
            config=dict(config),
            reinit="create_new",  # several trainings may run in one process
            settings=wandb.Settings(silent=True, console="off", init_timeout=PATIENCE),
        )

    def row(self, step: int, metrics: Mapping[str, float]) -> None:
        """Send one row; the client has threads and files of its own."""
        self._run.log(dict(metrics), step=step)

    def end(self, status: Status) -> None:
        """Wait until everything is sent, and close the run."""
        self._run.finish(exit_code=EXIT_CODES[status])
