"""Kills trainings and looks at what they leave."""

import random
import re
import shutil
import time
from collections import Counter
from pathlib import Path
from typing import Any

from jaxleas.files.npz import DamagedError
from jaxleas.runs.folder import RunFolder
from jaxleas.types import InputError
from tests.robustness.kills.moments import cut_power, draw_moment, signal_of
from tests.robustness.kills.training import UPDATES, Training, content, write_config

INTERRUPTED = 130


class Killer:
    """Trains, kills, goes on, compares.

    Attributes:
        kills: so far.
        resumes: processes that went on in a folder that a kill had left.
        equal: runs that ended equal to the one never interrupted.
        failures: sentences; empty as long as all is well.
    """

    def __init__(self, folder: Path, draw: random.Random) -> None:
        self._folder, self._draw = folder, draw
        self.kills = self.resumes = self.equal = 0
        self.failures: list[str] = []
        self._by: Counter[str] = Counter()
        self._lost_steps = 0
        self._damaged: dict[Path, bytes] = {}  # by us, and what they held then
        self._config = folder / "tiny.yaml"
        write_config(self._config)
        self._run = folder / "run"
        shutil.rmtree(folder / "whole", ignore_errors=True)
        shutil.rmtree(self._run, ignore_errors=True)
        self._whole, self._every, self._seconds = self._uninterrupted()

    @property
    def is_under_way(self) -> bool:
        """Whether a run is not at its end."""
        return self._run.exists()

    def one_process(self, kill: bool) -> None:
        """Start a process that begins a run or goes on with it; kill it, or let it end."""
        begun = (self._run / "provenance.json").is_file()
        if not begun:  # killed at birth: train.py wants such a folder away
            shutil.rmtree(self._run, ignore_errors=True)
        moment = draw_moment(self._draw, self._run, UPDATES, self._seconds)
        training = self._start(begun)
        if kill and moment.await_(self._run, training.is_alive):
            code = training.end(signal_of(moment.how))
            self._check_code(code, training, moment.how)
            self._note_resume(begun, training)
            self._after_kill(moment.when, moment.how)
            return
        self._check_code(training.end(), training, None)
        self._note_resume(begun, training)
        self._compare()

    def report(self) -> dict[str, Any]:
        """Return what was done and found, as plain values."""
        return {
            "kills": self.kills,
            "resumes": self.resumes,
            "runs_ended": self._by["ended"],
            "runs_bitwise_equal": self.equal,
            "corrupt_folders": self._by["corrupt"],
            "failures": self.failures,
            "of_the_kills": {
                name: self._by[name]
                for name in ("SIGKILL", "SIGTERM", "power cut", "time", "progress", "writing")
            },
            "left_a_half_written_checkpoint": self._by["half-written"],
            "killed_before_the_folder_was_made": self._by["at birth"],
            "damaged_checkpoints_passed_over": self._by["passed over"],
            "training_steps_lost_by_them": self._lost_steps,
        }

    def _uninterrupted(self) -> tuple[dict[str, object], dict[str, object], float]:
        """Return the content of a run left in peace, all its checkpoints, and how long it took."""
        found = []
        for name, extra in (("every", ["--checkpoints.keep_last", "999"]), ("whole", [])):
            shutil.rmtree(self._folder / name, ignore_errors=True)
            begun = time.monotonic()
            arguments = [str(self._config), "--run-dir", str(self._folder / name), *extra]
            training = Training(arguments, self._folder / "log")
            if training.end() != 0:
                raise RuntimeError(f"the training itself failed:\n{training.output}")
            seconds = time.monotonic() - begun  # of the second: all is compiled then
            found.append(content(self._folder / name))
        every, whole = found
        if differences(whole, every | {"config": whole["config"]}, _checkpoints(every)):
            raise RuntimeError("two trainings that nobody interrupted differ")
        return whole, _checkpoints(every), seconds

    def _start(self, begun: bool) -> Training:
        if begun:
            return Training(["--resume", str(self._run)], self._folder / "log")
        arguments = [str(self._config), "--run-dir", str(self._run)]
        return Training(arguments, self._folder / "log")

    def _note_resume(self, begun: bool, training: Training) -> None:
        self.resumes += begun
        for lost in re.findall(r"(\d+) steps are lost", training.output):
            self._by["passed over"] += 1
            self._lost_steps += int(lost)

    def _check_code(self, code: int, training: Training, how: str | None) -> None:
        wanted = {None: (0,), "SIGTERM": (0, INTERRUPTED, -15)}.get(how, (0, -9))
        if code not in wanted or "Traceback" in training.output:
            self.failures.append(f"after {how or 'no signal'} exit code {code}: {training.output}")

    def _after_kill(self, when: str, how: str) -> None:
        self.kills += 1
        self._by.update((when, how))
        self._by["half-written"] += any(self._run.glob("checkpoints/.*"))
        if not (self._run / "provenance.json").is_file():
            self._by["at birth"] += 1
            return
        still = {
            path: bytes_
            for path, bytes_ in self._damaged.items()
            if path.is_file() and path.read_bytes() == bytes_
        }
        try:
            content(self._run, still)
            RunFolder.open(self._run, needs_checkpoint=False)
        except (InputError, DamagedError, OSError) as error:
            self._by["corrupt"] += 1
            self.failures.append(f"corrupt after {how}: {error!r}")
        if how == "power cut":
            self._damaged = still | cut_power(self._draw, self._run)

    def _compare(self) -> None:
        self._by["ended"] += 1
        try:
            found = content(self._run)
        except (InputError, DamagedError, OSError) as error:
            self.failures.append(f"a run ended corrupt: {error}")
            return
        other = differences(self._whole, found, self._every)
        if other:
            self.failures.append(f"a run ended different in {', '.join(sorted(other))}")
            return
        self.equal += 1
        shutil.rmtree(self._run)


def differences(
    whole: dict[str, object], found: dict[str, object], every: dict[str, object]
) -> list[str]:
    """Return in what an interrupted run differs from one left in peace.

    A kill between the last checkpoint's writing and the oldest one's removal leaves the oldest. An
    interruption between two examinations saves a checkpoint of its own: as one of the last few it
    may stand in the place of an older one. Everything else must be there, and the same.

    Args:
        whole: content of the run left in peace.
        found: content of the other.
        every: checkpoints of a run that kept those of all examinations.
    """
    wanted = whole | {name: every[name] for name in found.keys() & every.keys()}
    own = {name for name in found.keys() - wanted.keys() if name.startswith("step_")}
    missing = sorted((whole.keys() & every.keys()) - found.keys() - {max(every)})
    names = (wanted.keys() | found.keys()) - own - set(missing[: len(own)])
    return sorted(name for name in names if wanted.get(name) != found.get(name))


def _checkpoints(found: dict[str, object]) -> dict[str, object]:
    return {name: each for name, each in found.items() if name.startswith("step_")}
