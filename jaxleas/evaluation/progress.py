"""Report what is being judged: one redrawn line in a terminal, silence elsewhere."""

import os
import sys
from types import TracebackType
from typing import Self, TextIO


class Reporter:
    """Shows the latest message in place, and clears it at the end.

    Without a terminal, or with CI or NO_COLOR set, it prints nothing: the table that follows is
    enough.

    Args:
        stream: stream to write to; standard error by default.
    """

    def __init__(self, stream: TextIO | None = None) -> None:
        self._stream = sys.stderr if stream is None else stream
        quiet = any(map(os.environ.get, ("CI", "NO_COLOR")))
        self._live = self._stream.isatty() and not quiet

    def say(self, text: str) -> None:
        """Show `text` in place of the previous message."""
        if self._live:
            self._stream.write(f"\r\x1b[K{text} ...")
            self._stream.flush()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self._live:
            self._stream.write("\r\x1b[K")
            self._stream.flush()
