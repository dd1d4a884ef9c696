"""Frame after frame: what moves on the page, live or into a recording."""

import time
from collections.abc import Sequence
from pathlib import Path
from typing import Protocol

from jaxleas.files import write_text
from jaxleas.viewer.recording import MOST_SECONDS, Recorder

FRAME = 1.0 / 32.0
"""Between two frames [s]: 30 a second are promised, and a busy machine is late now and then."""


class Player(Protocol):
    """What moves on the page."""

    @property
    def busy(self) -> bool:
        """Whether it has more to show by itself."""
        ...

    def frame(self, seconds: float) -> None:
        """Let time pass."""
        ...


def show(players: Sequence[Player], recorder: Recorder) -> None:
    """Show frames, evenly spaced, until somebody presses Ctrl-C."""
    before = due = time.monotonic()
    while True:
        now = time.monotonic()
        for player in players:
            player.frame(now - before)
        recorder.frame(now - before)
        before = now
        due = max(due + FRAME, time.monotonic())  # what is late is not made up for
        time.sleep(max(0.0, due - time.monotonic()))


def write_recording(path: Path, recorder: Recorder, players: Sequence[Player]) -> None:
    """Play everything once, as fast as it goes, and write it."""
    recorder.start()
    seconds = 0.0
    while any(player.busy for player in players) and seconds < MOST_SECONDS:
        for player in players:
            player.frame(FRAME)
        recorder.frame(FRAME)
        seconds += FRAME
    write_text(path, recorder.finish())
    print(f"{path}: {seconds:.0f} s, opens in any browser")
