import os
import random
import signal
import stat
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from jaxleas.files import atomic_path, read_json, read_npz, write_json, write_npz, write_text
from jaxleas.types.errors import InputError


def test_json_comes_back(tmp_path: Path) -> None:
    value = {"a": [1, 0.1, None, True, "é"], "b": {}}
    write_json(tmp_path / "new" / "x.json", value)
    assert read_json(tmp_path / "new" / "x.json") == value


def test_arrays_come_back(tmp_path: Path) -> None:
    heights = np.array([[0.5, np.nan]], np.float32)
    write_npz(tmp_path / "x.npz", heights=heights, resolution=np.float64(0.04))
    arrays = read_npz(tmp_path / "x.npz", ("heights", "resolution"))
    np.testing.assert_array_equal(arrays["heights"], heights)
    assert arrays["heights"].dtype == np.float32


def test_a_failure_while_writing_keeps_the_old_file_and_leaves_no_other(tmp_path: Path) -> None:
    path = tmp_path / "x.txt"
    write_text(path, "old")

    def fail() -> None:
        with atomic_path(path) as temporary:
            temporary.write_text("half")
            raise RuntimeError

    with pytest.raises(RuntimeError):
        fail()
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_permissions_are_those_of_any_new_file(tmp_path: Path) -> None:
    write_text(tmp_path / "ours", "x")
    (tmp_path / "theirs").touch()
    modes = {stat.S_IMODE((tmp_path / name).stat().st_mode) for name in ("ours", "theirs")}
    assert len(modes) == 1


def test_a_full_disk_is_one_sentence_and_keeps_the_old_file(tmp_path: Path, monkeypatch) -> None:
    path = tmp_path / "x.json"
    write_json(path, 1)

    def no_space(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", no_space)
    with pytest.raises(InputError, match=r"cannot write .*x.json: No space left on device"):
        write_json(path, 2)
    assert read_json(path) == 1
    assert list(tmp_path.iterdir()) == [path]


def test_json_has_neither_nan_nor_infinity(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="not JSON compliant"):
        write_json(tmp_path / "x.json", float("nan"))
    (tmp_path / "x.json").write_text('{"a": NaN}')
    with pytest.raises(InputError, match="holds NaN"):
        read_json(tmp_path / "x.json")


@pytest.mark.parametrize("content", [b"", b"{", b"[" * 100_000, b"\xff\xfe", b"{'a': 1}"])
def test_what_is_not_json_is_refused(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "x.json").write_bytes(content)
    with pytest.raises(InputError, match=r"x.json is not valid JSON"):
        read_json(tmp_path / "x.json")


def test_missing_files_and_folders_are_named(tmp_path: Path) -> None:
    for read in (read_json, lambda path: read_npz(path, ())):
        with pytest.raises(InputError, match="nowhere does not exist"):
            read(tmp_path / "nowhere")
        with pytest.raises(InputError, match="is a folder"):
            read(tmp_path)


def test_a_missing_array_is_named(tmp_path: Path) -> None:
    write_npz(tmp_path / "x.npz", a=np.zeros(1))
    with pytest.raises(InputError, match=r"lacks the array heights; it holds a"):
        read_npz(tmp_path / "x.npz", ("a", "heights"))


def test_python_objects_are_refused(tmp_path: Path) -> None:
    np.savez(tmp_path / "x.npz", allow_pickle=True, a=np.array([print], dtype=object))
    with pytest.raises(InputError, match="not a readable"):
        read_npz(tmp_path / "x.npz", ("a",))


def test_a_damaged_archive_is_refused_or_right(tmp_path: Path) -> None:
    """Truncated anywhere, or with any bit flipped: never wrong numbers, never a traceback."""
    path = tmp_path / "x.npz"
    draw = random.Random(0)
    right = np.random.default_rng(0).normal(size=(20, 10))
    write_npz(path, heights=right, resolution=np.float64(0.04))
    whole = path.read_bytes()
    refused = 0
    for trial in range(1000):
        at = draw.randrange(len(whole))
        damaged = bytearray(whole) if trial % 4 else bytearray(whole[:at])
        if trial % 4:
            damaged[at] ^= 1 << draw.randrange(8)
        path.write_bytes(damaged)
        try:
            arrays = read_npz(path, ("heights", "resolution"))
        except InputError:
            refused += 1
            continue
        np.testing.assert_array_equal(arrays["heights"], right)
        assert arrays["resolution"] == 0.04
    assert refused > 900


WRITER = """
import sys
from jaxleas.files.atomic import write_text
print("ready", flush=True)
step = 0
while True:
    step += 1
    write_text(sys.argv[1], str(step % 10) * 1_000_000)
"""


def test_killed_while_writing_the_file_is_always_whole(tmp_path: Path) -> None:
    path = tmp_path / "x.txt"
    write_text(path, "0" * 1_000_000)
    draw = random.Random(0)
    for _ in range(3):
        process = subprocess.Popen(
            [sys.executable, "-c", WRITER, str(path)], stdout=subprocess.PIPE, text=True
        )
        assert process.stdout is not None
        process.stdout.readline()
        time.sleep(draw.uniform(0.0, 0.05))
        process.send_signal(signal.SIGKILL)
        process.communicate()
        text = path.read_text()
        assert len(text) == 1_000_000
        assert len(set(text)) == 1
