"""Weights & Biases; set up by its own variables (WANDB_PROJECT, WANDB_MODE=offline, ...)."""

from collections.abc import Mapping
from importlib import import_module
from pathlib import Path
from typing import Any
from uuid import uuid4

from jaxleas.runs.watching.identity import lasting_identity
from jaxleas.runs.watching.watcher import Status
from jaxleas.types.errors import InputError

PROJECT = "jaxleas"
"""Where WANDB_PROJECT names none."""
PATIENCE = 25.0
"""For an answer of the server; less than the audience's farewell, so that no process hangs [s]."""
EXIT_CODES: dict[Status, int] = {"finished": 0, "interrupted": 130, "failed": 1}


def require_usable(wandb: Any) -> None:
    """Refuse a client that would ask for a key in mid-run.

    Raises:
        InputError: it is on-line and knows no key.
    """
    settings = wandb.setup().settings
    if settings.mode != "online" or settings.api_key:
        return
    if not wandb.login(prompt=False, verify=False):
        raise InputError("watch: wandb knows no key: run `wandb login`, or set WANDB_MODE=offline")


class WandbWatcher:
    """A run of Weights & Biases; a resumed training goes on in it.

    Args:
        folder: of the run; holds `wandb.json`, the identity, and `wandb/`, the client's own files.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder

    def begin(self, config: Mapping[str, Any], name: str, resumed_after: int | None) -> None:
        """Open the run; rows that it has already are passed over by the client."""
        wandb: Any = import_module("wandb")
        project = wandb.setup().settings.project
        self._run = wandb.init(
            project=project or PROJECT,
            id=lasting_identity(self._folder / "wandb.json", lambda: uuid4().hex[:16]),
            resume="allow",
            name=name,
            dir=str(self._folder),
            config=dict(config),
            reinit="create_new",  # several trainings may go on in one process
            settings=wandb.Settings(silent=True, console="off", init_timeout=PATIENCE),
        )

    def row(self, step: int, metrics: Mapping[str, float]) -> None:
        """Send one row; the client has threads and files of its own."""
        self._run.log(dict(metrics), step=step)

    def end(self, status: Status) -> None:
        """Wait for what is under way, and close."""
        self._run.finish(exit_code=EXIT_CODES[status])
