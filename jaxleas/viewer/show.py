"""The frames of the page, shown live or written to a recording."""

import time
from collections.abc import Sequence
from pathlib import Path
from typing import Protocol

from jaxleas.files import write_text
from jaxleas.viewer.recording import MOST_SECONDS, Recorder

FRAME = 1.0 / 32.0
"""Time between two frames [s]: 30 per second are promised, and a busy machine is late at times."""


class Player(Protocol):
    """An object that moves on the page."""

    @property
    def busy(self) -> bool:
        """Whether it has more to show without user actions."""
        ...

    def frame(self, seconds: float) -> None:
        """Advance by one frame."""
        ...


def show(players: Sequence[Player], recorder: Recorder) -> None:
    """Show frames, evenly spaced, until Ctrl-C."""
    before = due = time.monotonic()
    while True:
        now = time.monotonic()
        for player in players:
            player.frame(now - before)
        recorder.frame(now - before)
        before = now
        due = max(due + FRAME, time.monotonic())  # a delay is not made up for
        time.sleep(max(0.0, due - time.monotonic()))


def write_recording(path: Path, recorder: Recorder, players: Sequence[Player]) -> None:
    """Play everything once, as fast as possible, and write the recording."""
    recorder.start()
    seconds = 0.0
    while any(player.busy for player in players) and seconds < MOST_SECONDS:
        for player in players:
            player.frame(FRAME)
        recorder.frame(FRAME)
        seconds += FRAME
    write_text(path, recorder.finish())
    print(f"{path}: {seconds:.0f} s, opens in any browser")
