"""Runs as their folders tell them, whole, half-written, foreign or at work."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jaxleas.cli import run as command
from jaxleas.records import find_runs, read_record
from jaxleas.runs.folder import RunFolder
from jaxleas.types.errors import InputError
from tests.records.folders import judge, make_run


def listed(capsys, *arguments: str) -> list[dict]:
    command(["runs", *arguments, "--json"])
    return json.loads(capsys.readouterr().out)


def test_a_finished_run_tells_everything(tmp_path: Path) -> None:
    path = make_run(tmp_path / "a", seed=3, ppo={"discount": 0.9})
    judge(path, {"bridge": 200, "rubble": 100})
    record = read_record(path)
    assert (record.state, record.problem) == ("finished", "")
    assert (record.steps, record.total, record.seconds) == (8000, 8000, 80.0)
    assert record.held_out == 0.9
    assert record.success == 0.75  # of its own policy: the baseline reaches nothing
    assert record.source == "leas_p1"
    assert record.differences.items() >= {("seed", 3), ("ppo.discount", 0.9)}
    assert "ppo.clip" not in record.differences


def test_states(tmp_path: Path) -> None:
    assert read_record(make_run(tmp_path / "done")).state == "finished"
    short = make_run(tmp_path / "short", updates=5)
    assert read_record(short).state == "interrupted"
    with RunFolder.open(short, writing=True, needs_checkpoint=False):
        assert read_record(short).state == "running"
    assert read_record(short).state == "interrupted"
    (short / "config.yaml").unlink()
    assert read_record(short).state == "damaged"


def test_a_run_that_lives_elsewhere_is_not_called_interrupted(tmp_path: Path) -> None:
    """Held by another process, or by another machine whose file system passes no locks on."""
    run = make_run(tmp_path / "a", updates=5)
    code = (
        "import sys, time; from jaxleas.runs.folder import RunFolder\n"
        "run = RunFolder.open(sys.argv[1], writing=True, needs_checkpoint=False)\n"
        "print('held', flush=True); time.sleep(60)"
    )
    with subprocess.Popen([sys.executable, "-c", code, run], stdout=subprocess.PIPE) as process:
        assert process.stdout is not None
        process.stdout.readline()
        assert read_record(run).state == "running"
        process.kill()
    assert read_record(run).state == "interrupted"
    (run / "lock").write_text(json.dumps({"process": 77, "host": "node7"}))
    assert read_record(run).state == "running"
    os.utime(run / "lock", (0, 0))
    assert read_record(run).state == "interrupted"


def test_a_training_that_begins_is_running_not_damaged(tmp_path: Path) -> None:
    run = make_run(tmp_path / "a", updates=1)
    with RunFolder.open(run, writing=True, needs_checkpoint=False):
        (run / "provenance.json").unlink()
        assert read_record(run).state == "running"


@pytest.mark.parametrize(
    ("name", "content", "problem"),
    [
        ("config.yaml", "ppo: [1", "is not a usable YAML file"),
        ("config.yaml", "ppo: 3\nseed: [1]", "ppo should hold `key: value` pairs"),
        ("config.yaml", "ppo: {steps: x}", "ppo.steps is 'x', which is no count"),
        ("config.yaml", "ppo: {unroll: 0}", "ppo.unroll is 0, which is no count"),
        ("config.yaml", "ppo: {steps: 1e300}", "which is no count"),
        ("provenance.json", "[]", "provenance cannot be understood"),
        ("provenance.json", '{"git": 3, "command": [], "created": 1}', "cannot be understood"),
        ("metrics.jsonl", "nonsense\n", "line 1 is not valid JSON"),
        ("metrics.jsonl", '{"step": "a", "seconds": []}\n', "metrics.jsonl is damaged: line 1"),
        ("evaluation/hole.json", "{}", "is no evaluation"),
    ],
)
def test_damage_is_a_sentence(tmp_path: Path, capsys, name, content, problem) -> None:
    run = make_run(tmp_path / "a")
    (run / "evaluation").mkdir()
    (run / name).write_text(content)
    record = read_record(run)
    assert record.state == "damaged"
    assert problem in record.problem
    command(["runs", str(tmp_path)])
    assert problem in capsys.readouterr().out
    with pytest.raises(InputError, match=problem):
        command(["compare", str(run), str(run)])


FILES = ("config.yaml", "provenance.json", "metrics.jsonl", "evaluation/transitions.json")


@pytest.fixture(scope="module")
def whole(tmp_path_factory) -> Path:
    run = make_run(tmp_path_factory.mktemp("fuzz") / "a")
    judge(run, {"bridge": 200})
    return run


@settings(max_examples=100)
@given(name=st.sampled_from(FILES), cut=st.floats(0.0, 1.0), junk=st.binary(max_size=8))
def test_no_damage_is_a_crash(whole: Path, name: str, cut: float, junk: bytes) -> None:
    file = whole / name
    content = file.read_bytes()
    try:
        file.write_bytes(content[: int(cut * len(content))] + junk)
        assert read_record(whole).state in ("finished", "interrupted", "damaged")
        command(["runs", str(whole)])
    finally:
        file.write_bytes(content)


def test_runs_are_found_wherever_they_lie(tmp_path: Path) -> None:
    for name in ("b", "sweep/trials/0001", "a"):
        make_run(tmp_path / name)
    make_run(tmp_path / "a" / "inside")  # a run's own folder is its own business
    make_run(tmp_path / ".hidden")
    (tmp_path / "foreign").mkdir()
    (tmp_path / "foreign" / "config.yaml").write_text("seed: 1")
    (tmp_path / "loop").symlink_to(tmp_path)
    (tmp_path / "half").mkdir()
    (tmp_path / "half" / "lock").touch()
    found = [str(path.relative_to(tmp_path)) for path in find_runs(tmp_path)]
    assert found == ["a", "b", "half", "sweep/trials/0001"]
    assert find_runs(tmp_path / "a") == [tmp_path / "a"]


def test_sorted_and_chosen(tmp_path: Path, capsys) -> None:
    make_run(tmp_path / "a", reached=0.5, seed=1)
    make_run(tmp_path / "b", reached=0.9, seed=2)
    make_run(tmp_path / "c", updates=1, seed=2)

    def names(*arguments: str) -> list[str]:
        found = listed(capsys, str(tmp_path), "--sort", "name", *arguments)
        return [Path(each["path"]).name for each in found]

    assert names() == ["a", "b", "c"]
    assert names("--sort", "held_out", "--reverse") == ["b", "a", "c"]  # the unknown come last
    assert names("--state", "interrupted", "damaged") == ["c"]
    assert names("--where", "seed=2", "ppo.steps=8000") == ["b", "c"]
    assert names("--name", "[ab]") == ["a", "b"]
    command(["runs", str(tmp_path), "--where", "seed=7"])
    assert "none of the 3 runs" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["runs", "nowhere"], "the folder nowhere does not exist"),
        (["runs", __file__], "is a file: give one that holds runs"),
        (["compare", __file__, __file__], "is a file"),
        (["runs", ".", "--where", "ppo.discont=1"], "perhaps you meant ppo.discount"),
        (["runs", ".", "--where", "seed"], "conditions look like ppo.discount=0.99"),
        (["runs", ".", "--where", "seed=[1"], "is not YAML"),
        (["compare", "a"], "give two run folders or more"),
        (["compare", "a", "nowhere"], "the run folder nowhere does not exist"),
        (["compare", "a", "empty"], "empty is not a run folder"),
    ],
)
def test_mistakes_are_sentences(tmp_path: Path, monkeypatch, arguments, message) -> None:
    monkeypatch.chdir(tmp_path)
    make_run(tmp_path / "a")
    (tmp_path / "empty").mkdir()
    with pytest.raises(InputError, match=message.replace("[", r"\[")):
        command(arguments)
