import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from jaxleas.runs.metrics import MetricsLog, read_metrics
from jaxleas.types.errors import InputError


def write_steps(folder: Path, steps: range, after: int | None = None) -> None:
    with MetricsLog(folder, truncate_after_step=after) as log:
        for step in steps:
            log.append(step, {"return": 1 / (step + 3), "held_out/success": 0.1 * step})


def without_seconds(folder: Path) -> list[dict]:
    return [{**row, "seconds": None} for row in read_metrics(folder / "metrics.jsonl")]


@pytest.mark.parametrize("killed_after", [0, 3, 7])
@pytest.mark.parametrize("torn", ["", '{"step": 9, "seco', '{"step": 9, "seconds": 1.0, "a": 2}'])
def test_interrupted_and_resumed_reads_as_if_never_interrupted(
    tmp_path: Path, killed_after: int, torn: str
) -> None:
    """Lines beyond the checkpoint and a line torn by the kill leave no trace."""
    write_steps(tmp_path / "whole", range(10))
    write_steps(tmp_path / "resumed", range(8))
    with (tmp_path / "resumed" / "metrics.jsonl").open("a") as stream:
        stream.write(torn)
    write_steps(tmp_path / "resumed", range(killed_after + 1, 10), after=killed_after)
    assert without_seconds(tmp_path / "resumed") == without_seconds(tmp_path / "whole")


def test_wall_time_goes_on_where_it_stopped(tmp_path: Path) -> None:
    write_steps(tmp_path, range(2))
    path = tmp_path / "metrics.jsonl"
    first, _ = path.read_text().splitlines(keepends=True)
    path.write_text(first.replace(f'"seconds": {json.loads(first)["seconds"]}', '"seconds": 500.0'))
    write_steps(tmp_path, range(1, 3), after=0)
    seconds = [row["seconds"] for row in read_metrics(path)]
    assert seconds == sorted(seconds)
    assert seconds[1] >= 500.0


def test_a_line_is_there_as_soon_as_it_is_appended(tmp_path: Path) -> None:
    code = (
        "import sys, time; from jaxleas.runs.metrics import MetricsLog\n"
        "log = MetricsLog(sys.argv[1]); log.append(5, {'a': 0.1}); print('x', flush=True)\n"
        "time.sleep(60)"
    )
    process = subprocess.Popen(
        [sys.executable, "-c", code, str(tmp_path)],
        stdout=subprocess.PIPE,
        env={**os.environ, "JAX_PLATFORMS": "cpu"},
    )
    assert process.stdout is not None
    process.stdout.readline()
    process.send_signal(signal.SIGKILL)
    process.communicate()
    (row,) = read_metrics(tmp_path / "metrics.jsonl")
    assert (row["step"], row["a"]) == (5, 0.1)


def test_what_is_not_finite_is_null(tmp_path: Path) -> None:
    with MetricsLog(tmp_path) as log:
        log.append(0, {"nan": float("nan"), "inf": float("inf"), "zero": 0})
    (row,) = read_metrics(tmp_path / "metrics.jsonl")
    assert (row["nan"], row["inf"], row["zero"]) == (None, None, 0.0)


def test_tensorboard_gets_the_same_numbers(tmp_path: Path) -> None:
    write_steps(tmp_path, range(3))
    (events,) = (tmp_path / "tensorboard").iterdir()
    assert b"held_out/success" in events.read_bytes()


def test_a_full_disk_is_one_sentence(tmp_path: Path) -> None:
    if not Path("/dev/full").exists():
        pytest.skip("needs /dev/full")
    log = MetricsLog(tmp_path)
    log._stream.close()
    with open("/dev/full", "w", buffering=1) as log._stream:
        with pytest.raises(InputError, match=r"cannot write .*metrics.jsonl: No space left"):
            log.append(0, {"a": 1.0})
        os.dup2(os.open(os.devnull, os.O_WRONLY), log._stream.fileno())  # so that it can close
    log.close()


@pytest.mark.parametrize("content", ["nonsense\n", "[1]\n", '{"step": 1}\n'])
def test_a_damaged_file_is_refused(tmp_path: Path, content: str) -> None:
    path = tmp_path / "metrics.jsonl"
    path.write_text(content)
    with pytest.raises(InputError, match=str(path)):
        read_metrics(path)


def test_a_missing_file_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="has logged nothing yet"):
        read_metrics(tmp_path / "metrics.jsonl")
