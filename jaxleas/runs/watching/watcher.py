"""The protocol of a watcher of a run."""

from collections.abc import Mapping
from typing import Any, Literal, Protocol

Status = Literal["finished", "interrupted", "failed"]


class Watcher(Protocol):
    """Receiver of what a run logs; it may be slow or fail: the training does not wait for it."""

    def begin(self, config: Mapping[str, Any], name: str, resumed_after: int | None) -> None:
        """Open the run, or continue it.

        Args:
            config: resolved configuration, as plain values.
            name: name of the run, for display.
            resumed_after: step of the checkpoint that was resumed; None for a new run. Rows after
                it are sent again.
        """
        ...

    def row(self, step: int, metrics: Mapping[str, float]) -> None:
        """Take one row of metrics.

        Args:
            step: number of training steps done.
            metrics: metrics by name; a number may be NaN or infinite.
        """
        ...

    def end(self, status: Status) -> None:
        """Close the run; an interrupted one may be continued later."""
        ...
