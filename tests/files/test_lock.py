"""A folder is held by one writer, also among machines that do not pass locks on."""

import fcntl
import json
import logging
import os
import signal
import subprocess
import sys
import threading
import time

import pytest

from jaxleas.files import FolderLock, InUseError, is_held, lock
from jaxleas.types import InputError

HOLD = (
    "import sys, time; from jaxleas.files import FolderLock\n"
    "FolderLock(sys.argv[1], 'the run folder', ''); print('held', flush=True); time.sleep(60)"
)


def hold(folder):
    return FolderLock(folder, "the run folder", "name another")


def said_by(folder, host, seconds_ago):
    """Leave a lock as a process on another machine does, whose file system passes no locks on."""
    path = folder / "lock"
    path.write_text(json.dumps({"process": 77, "host": host}))
    then = time.time() - seconds_ago
    os.utime(path, (then, then))


def test_held_once_and_free_again(tmp_path):
    with hold(tmp_path), pytest.raises(InputError, match=f"in use by process {os.getpid()};"):
        hold(tmp_path)
    hold(tmp_path).close()


def test_a_holder_on_another_machine_that_shows_signs_of_life_is_believed(tmp_path):
    said_by(tmp_path, "node7", 20)
    with pytest.raises(InputError, match=r"by process 77 on node7, .* (19|20|21) s ago; if it is"):
        hold(tmp_path)
    assert time.time() - (tmp_path / "lock").stat().st_mtime > 15  # looking is no sign of life
    assert [each.name for each in tmp_path.iterdir()] == ["lock"]


def test_one_that_has_been_silent_is_dead(tmp_path, caplog):
    said_by(tmp_path, "node7", lock.SILENCE + 5)
    with caplog.at_level(logging.WARNING), hold(tmp_path):
        assert "left behind by process 77 on node7" in caplog.text


def test_the_holder_shows_signs_of_life_and_leaves_none_behind(tmp_path, monkeypatch):
    monkeypatch.setattr(lock, "PULSE", 0.02)
    with hold(tmp_path):
        os.utime(tmp_path / "lock", (0, 0))
        deadline = time.monotonic() + 5
        while (tmp_path / "lock").stat().st_mtime == 0 and time.monotonic() < deadline:
            time.sleep(0.01)
        assert time.time() - (tmp_path / "lock").stat().st_mtime < 5
    assert (tmp_path / "lock").read_text() == ""


def test_a_lock_of_the_version_before_is_understood(tmp_path, caplog):
    (tmp_path / "lock").write_text("4711\n")
    with caplog.at_level(logging.WARNING), hold(tmp_path):
        assert "left behind by process 4711," in caplog.text


def test_death_frees_it_and_is_told(tmp_path, caplog):
    process = subprocess.Popen([sys.executable, "-c", HOLD, str(tmp_path)], stdout=subprocess.PIPE)
    process.stdout.readline()
    with pytest.raises(InputError, match=f"in use by process {process.pid}"):
        hold(tmp_path)
    process.send_signal(signal.SIGKILL)
    process.communicate()
    with caplog.at_level(logging.WARNING), hold(tmp_path):
        assert f"left behind by process {process.pid}" in caplog.text


def test_asking_who_holds_it_agrees_with_trying_to_take_it(tmp_path):
    assert not is_held(tmp_path)
    assert not list(tmp_path.iterdir())  # asking makes no lock
    with subprocess.Popen([sys.executable, "-c", HOLD, tmp_path], stdout=-1) as process:
        assert process.stdout is not None
        process.stdout.readline()
        assert is_held(tmp_path)
        process.kill()
    assert not is_held(tmp_path)  # although its lock still names it
    with hold(tmp_path):
        assert is_held(tmp_path)
    for seconds, expected in ((20, True), (lock.SILENCE + 5, False)):
        said_by(tmp_path, "node7", seconds)
        assert is_held(tmp_path) is expected


def test_whether_it_is_held_can_be_asked_where_nothing_can_be_written(tmp_path, monkeypatch):
    def refused(dir):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr("jaxleas.files.lock_holder.TemporaryFile", refused)
    said_by(tmp_path, "node7", 20)
    assert is_held(tmp_path)
    said_by(tmp_path, "node7", lock.SILENCE + 5)
    assert not is_held(tmp_path)


def test_one_that_only_asks_is_not_taken_for_the_holder(tmp_path):
    """Whoever asks holds a shared lock for a moment: a training that begins just then waits."""
    with (tmp_path / "lock").open("w") as asking:
        fcntl.flock(asking, fcntl.LOCK_SH)
        threading.Timer(0.05, fcntl.flock, (asking, fcntl.LOCK_UN)).start()
        hold(tmp_path).close()


def test_in_use_is_a_kind_of_error_and_not_a_word_in_it(tmp_path):
    with hold(tmp_path), pytest.raises(InUseError):
        hold(tmp_path)
    said_by(tmp_path, "node7", 20)
    with pytest.raises(InUseError):
        hold(tmp_path)
