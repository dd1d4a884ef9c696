import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from jaxleas.runs import provenance
from jaxleas.runs.folder import RunFolder
from jaxleas.types.errors import InputError

COMMAND = ["train.py", "c.yaml"]


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "runs" / "one"


def make_run(path: Path, checkpoint: bool = True) -> None:
    RunFolder.create(path, "seed: 1\n", COMMAND).close()
    if checkpoint:
        (path / "checkpoints").mkdir()
        (path / "checkpoints" / "step_000000000000.npz").touch()


def refusal(action, *arguments, **options) -> str:
    with pytest.raises(InputError) as caught:
        action(*arguments, **options)
    assert "\n" not in str(caught.value)
    return str(caught.value)


def test_a_new_run_records_where_it_comes_from(path: Path) -> None:
    make_run(path)
    record = json.loads((path / "provenance.json").read_text())
    assert (path / "config.yaml").read_text() == "seed: 1\n"
    assert record["format"] == 1
    assert record["command"] == COMMAND
    assert record["packages"]["jax"].count(".") >= 2
    assert record["machine"]["cores"] == os.cpu_count()
    with RunFolder.open(path, writing=True) as run:
        assert run.config.is_file()
        assert run.checkpoints.is_dir()


def test_an_existing_run_is_never_overwritten(path: Path) -> None:
    make_run(path)
    sentence = refusal(RunFolder.create, path, "seed: 2\n", COMMAND)
    assert "not empty" in sentence
    assert f"--resume {path}" in sentence
    assert (path / "config.yaml").read_text() == "seed: 1\n"


def test_a_folder_with_anything_in_it_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "thesis.tex").touch()
    assert "not empty" in refusal(RunFolder.create, tmp_path, "", COMMAND)
    assert [entry.name for entry in tmp_path.iterdir()] == ["thesis.tex"]


def test_an_empty_folder_and_one_killed_at_birth_can_be_used(path: Path) -> None:
    path.mkdir(parents=True)
    (path / "lock").write_text("1\n")
    make_run(path)
    RunFolder.open(path).close()


def test_a_file_in_the_way_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    for path in (tmp_path / "file", tmp_path / "file" / "inside"):
        assert str(path) in refusal(RunFolder.create, path, "", COMMAND)


def test_two_writers_are_refused_and_a_reader_is_not(path: Path) -> None:
    make_run(path)
    with RunFolder.open(path, writing=True):
        for action in (
            lambda: RunFolder.open(path, writing=True),
            lambda: RunFolder.create(path, "", COMMAND),
        ):
            assert f"in use by process {os.getpid()}" in refusal(action)
        RunFolder.open(path).close()
    RunFolder.open(path, writing=True).close()


def test_the_hold_of_another_process_ends_with_its_death(path: Path) -> None:
    make_run(path)
    code = (
        "import sys, time; from jaxleas.runs.folder import RunFolder\n"
        "run = RunFolder.open(sys.argv[1], writing=True); print('held', flush=True)\n"
        "time.sleep(60)"
    )
    process = subprocess.Popen(
        [sys.executable, "-c", code, str(path)],
        stdout=subprocess.PIPE,
        env={**os.environ, "JAX_PLATFORMS": "cpu"},
    )
    assert process.stdout is not None
    process.stdout.readline()
    sentence = refusal(RunFolder.open, path, writing=True)
    assert f"{path} is in use by process {process.pid}" in sentence
    process.send_signal(signal.SIGKILL)
    process.communicate()
    RunFolder.open(path, writing=True).close()


@pytest.mark.parametrize("writing", [False, True])
def test_what_is_no_run_is_refused(tmp_path: Path, path: Path, writing: bool) -> None:
    assert "does not exist" in refusal(RunFolder.open, path, writing)
    assert "is not a run folder" in refusal(RunFolder.open, tmp_path, writing)
    assert not list(tmp_path.iterdir()), "looking leaves nothing behind"
    (tmp_path / "policy.onnx").touch()
    assert "is a file" in refusal(RunFolder.open, tmp_path / "policy.onnx", writing)


@pytest.mark.parametrize("missing", ["config.yaml", "provenance.json"])
def test_a_half_written_run_is_refused(path: Path, missing: str) -> None:
    make_run(path)
    (path / missing).unlink()
    assert "half-written" in refusal(RunFolder.open, path)


def test_a_run_without_a_checkpoint_can_be_resumed_but_not_read(path: Path) -> None:
    make_run(path, checkpoint=False)
    assert "no checkpoint yet" in refusal(RunFolder.open, path)
    RunFolder.open(path, writing=True, needs_checkpoint=False).close()


@pytest.mark.parametrize(
    ("record", "expected"),
    [
        ('{"format": 99, "jaxleas": "7.0"}', "in format 99, written by jaxleas 7.0"),
        ("{}", "in format None"),
        ("[]", "in format None"),
        ('{"format', "provenance.json is not valid JSON"),
    ],
)
def test_another_version_is_refused(path: Path, record: str, expected: str) -> None:
    make_run(path)
    (path / "provenance.json").write_text(record)
    assert expected in refusal(RunFolder.open, path)
    assert expected in refusal(RunFolder.open, path, writing=True)
    (path / "provenance.json").write_text('{"format": 1}')
    RunFolder.open(path, writing=True).close()  # a refusal holds nothing


def test_a_full_disk_is_one_sentence(path: Path, monkeypatch) -> None:
    def no_space(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", no_space)
    sentence = refusal(RunFolder.create, path, "seed: 1\n", COMMAND)
    assert "No space left on device" in sentence
    monkeypatch.undo()
    make_run(path)  # the failure left nothing in the way


def git(folder: Path, *arguments: str) -> None:
    identity = ["-c", "user.name=t", "-c", "user.email=t@example.org"]
    subprocess.run(["git", "-C", str(folder), *identity, *arguments], check=True)


def test_revision_and_changes_are_recorded(tmp_path: Path, path: Path, monkeypatch) -> None:
    source = tmp_path / "source"
    (source / "jaxleas").mkdir(parents=True)
    module = source / "jaxleas" / "__init__.py"
    module.write_text("one = 1\n")
    monkeypatch.setattr(provenance, "_SOURCE", source)
    git(tmp_path, "init", "-q", str(source))
    assert provenance.collect_provenance(COMMAND)[0]["git"] is None, "not committed yet"
    git(source, "add", ".")
    git(source, "commit", "-q", "-m", "x")
    record, diff = provenance.collect_provenance(COMMAND)
    assert len(record["git"]["revision"]) == 40
    assert (record["git"]["changed"], record["git"]["untracked"], diff) == (False, [], "")
    module.write_text("one = 2\n")
    (source / "new.py").touch()
    make_run(path)
    record = json.loads((path / "provenance.json").read_text())
    assert (record["git"]["changed"], record["git"]["untracked"]) == (True, ["new.py"])
    assert "+one = 2" in (path / "provenance.diff").read_text()


def test_a_package_inside_a_foreign_repository_claims_no_revision(tmp_path, monkeypatch) -> None:
    (tmp_path / "mine.py").touch()
    git(tmp_path, "init", "-q")
    git(tmp_path, "add", ".")
    git(tmp_path, "commit", "-q", "-m", "x")
    (tmp_path / "jaxleas").mkdir()
    (tmp_path / "jaxleas" / "__init__.py").touch()
    monkeypatch.setattr(provenance, "_SOURCE", tmp_path)
    assert provenance.collect_provenance(COMMAND)[0]["git"] is None


def test_without_git_there_is_no_revision(tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    assert provenance.collect_provenance(COMMAND)[0]["git"] is None
