"""TensorBoard: event files in the run folder, without using the network."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from jaxleas.runs.watching.watcher import Status


class TensorBoardWatcher:
    """Watcher that writes `tensorboard/` in the run folder.

    Args:
        folder: run folder.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder / "tensorboard"

    def begin(self, config: Mapping[str, Any], name: str, resumed_after: int | None) -> None:
        """Open an event file; rows after `resumed_after` of earlier files are hidden."""
        from tensorboardX import SummaryWriter  # slow to import and needed only in training

        purge = None if resumed_after is None else resumed_after + 1
        self._board = SummaryWriter(str(self._folder), purge_step=purge, flush_secs=10)

    def row(self, step: int, metrics: Mapping[str, float]) -> None:
        """Write one point for every metric."""
        for name, value in metrics.items():
            self._board.add_scalar(name, value, step)

    def end(self, status: Status) -> None:
        """Close the file."""
        self._board.close()
