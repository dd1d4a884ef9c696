"""What CI runs beside the tests: it fetches a browser if it can, and names what was skipped."""

import os
import shutil
import subprocess
from pathlib import Path

import pytest

CI = Path(__file__).resolve().parents[1] / ".ci"
pytestmark = pytest.mark.skipif(os.name != "posix", reason="a script of bash")
ANSWERS = {"fails": "exit 100", "hangs": "exec sleep 60"}


def program(folder: Path, name: str, body: str) -> None:
    (folder / name).write_text(f"#!/bin/sh\n{body}\n")
    (folder / name).chmod(0o755)


@pytest.mark.parametrize("answer", ANSWERS)
def test_a_browser_that_cannot_be_had_fails_nothing(answer: str, tmp_path: Path) -> None:
    for name in ("bash", "timeout", "sleep"):
        found = shutil.which(name)
        assert found
        (tmp_path / name).symlink_to(found)
    program(tmp_path, "id", "echo 0")
    program(tmp_path, "apt-get", ANSWERS[answer])
    done = subprocess.run(
        [CI / "get-chromium", "0.5"],
        env={"PATH": str(tmp_path)},
        capture_output=True,
        text=True,
        timeout=30,
        check=False,
    )
    assert done.returncode == 0
    assert "cannot be had from apt-get within 0.5 s: tests of pages will be skipped" in done.stdout


SKIPPED = "SKIPPED [2] tests/browser.py:29: no Chromium here"


@pytest.mark.parametrize(
    ("tests", "code", "said"),
    [
        ("echo 9 passed", 0, "Nothing was skipped.\n"),
        (f"echo '{SKIPPED}'", 0, "!!!   2 x tests/browser.py:29: no Chromium here\n"),
        ("false", 2, ""),
    ],
)
def test_what_was_skipped_is_said_at_the_end(
    tests: str, code: int, said: str, tmp_path: Path
) -> None:
    for name in ("chromium", "chromedriver"):
        program(tmp_path, name, "")
    program(tmp_path, "make", f'case "$1" in test) {tests} || exit 2;; esac')
    done = subprocess.run(
        [CI / "run"],
        env=os.environ | {"PATH": f"{tmp_path}:{os.environ['PATH']}"},
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert (done.returncode, done.stdout[-len(said) :] if said else "") == (code, said), done
