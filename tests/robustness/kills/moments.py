"""When a training is killed, and what becomes of its files when the power goes with it."""

import json
import os
import random
import signal
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

When = Literal["time", "progress", "writing"]
How = Literal["SIGKILL", "SIGTERM", "power cut"]
POLL = 2e-4  # [s]


@dataclass(frozen=True)
class Moment:
    """One kill, drawn before the process starts.

    Attributes:
        when: so many seconds after the start; when so many rows are logged; or while a checkpoint
            is being written.
        how: a power cut is a SIGKILL after which the newest files are damaged.
        amount: seconds, rows or checkpoints to wait for.
        pause: after that [s].
    """

    when: When
    how: How
    amount: float
    pause: float

    def await_(self, run: Path, is_alive: Callable[[], bool]) -> bool:
        """Wait; return whether the process still lives then."""
        begun, seen, last = time.monotonic(), 0, ""
        while is_alive():
            if self.when == "time" and time.monotonic() - begun >= self.amount:
                break
            if self.when == "progress" and rows_of(run) >= self.amount:
                break
            if self.when == "writing":
                name = _half_written(run)
                seen += name not in ("", last)
                last = name or last
                if seen >= self.amount:
                    break
            time.sleep(POLL if self.when == "writing" else 0.005)
        time.sleep(self.pause)
        return is_alive()


def draw_moment(draw: random.Random, run: Path, rows: int, seconds: float) -> Moment:
    """Return a moment, anywhere in the rest of a run.

    Args:
        draw: randomness.
        run: folder of the run, as it is now.
        rows: of the whole run.
        seconds: that a process takes for all of it.
    """
    when = draw.choices(("time", "progress", "writing"), (25, 35, 40))[0]
    how = draw.choices(("SIGKILL", "SIGTERM", "power cut"), (50, 15, 35))[0]
    if when == "time":
        return Moment("time", how, draw.uniform(0.0, seconds), 0.0)
    if when == "progress":
        target = draw.randint(min(rows_of(run) + 1, rows), rows)
        return Moment("progress", how, target, draw.uniform(0, 0.05))
    return Moment("writing", how, draw.randint(1, 4), draw.uniform(0.0, 0.004))


def signal_of(how: How) -> signal.Signals:
    """Return the signal that is sent."""
    return signal.SIGTERM if how == "SIGTERM" else signal.SIGKILL


def cut_power(draw: random.Random, run: Path) -> dict[Path, bytes]:
    """Damage the newest checkpoint and the last rows as a power cut might.

    Returns:
        The damaged checkpoint and what it holds now, if there was one.
    """
    damaged = {}
    checkpoints = sorted((run / "checkpoints").glob("step_*.npz"))
    if checkpoints:
        damaged[checkpoints[-1]] = _damage(draw, checkpoints[-1])
    metrics = run / "metrics.jsonl"
    if metrics.is_file():
        # Rows up to the newest checkpoint were on the disk before it; later ones may be lost.
        kept = _length_up_to(metrics, int(checkpoints[-1].stem[5:]) if checkpoints else 0)
        whole = metrics.read_bytes()
        end = draw.randint(kept, len(whole))
        metrics.write_bytes(whole[:end] + draw.choice((b"", b"\0" * 40, b'{"step": 7')))
    return damaged


def rows_of(run: Path) -> int:
    """Return the number of rows logged."""
    try:
        return (run / "metrics.jsonl").read_bytes().count(b"\n")
    except OSError:
        return 0


def _damage(draw: random.Random, path: Path) -> bytes:
    whole = bytearray(path.read_bytes())
    at = draw.randrange(len(whole))
    kind = draw.choice(("truncated", "zeroed from", "flipped at"))
    if kind == "truncated":
        del whole[at:]
    elif kind == "zeroed from":
        whole[at:] = bytes(len(whole) - at)
    else:
        whole[at] ^= 1 << draw.randrange(8)
    path.write_bytes(whole)
    return bytes(whole)


def _length_up_to(metrics: Path, step: int) -> int:
    length = 0
    for line in metrics.read_bytes().splitlines(keepends=True):
        if not line.endswith(b"\n") or json.loads(line)["step"] > step:
            break
        length += len(line)
    return length


def _half_written(run: Path) -> str:
    try:
        with os.scandir(run / "checkpoints") as entries:
            return next((each.name for each in entries if each.name.startswith(".")), "")
    except OSError:
        return ""
