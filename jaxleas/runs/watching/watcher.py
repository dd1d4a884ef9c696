"""What a watcher of a run is."""

from collections.abc import Mapping
from typing import Any, Literal, Protocol

Status = Literal["finished", "interrupted", "failed"]


class Watcher(Protocol):
    """Is told what a run logs; may be slow and may fail: the training does not wait for it."""

    def begin(self, config: Mapping[str, Any], name: str, resumed_after: int | None) -> None:
        """Open the run, or go on in it.

        Args:
            config: the resolved configuration, as plain values.
            name: of the run, for people.
            resumed_after: step of the checkpoint gone on from; None for a new run. Rows after it
                come again.
        """
        ...

    def row(self, step: int, metrics: Mapping[str, float]) -> None:
        """Take one row of metrics.

        Args:
            step: training steps done.
            metrics: by name; a number may be NaN or infinite.
        """
        ...

    def end(self, status: Status) -> None:
        """Close the run; an interrupted one may be gone on with."""
        ...
