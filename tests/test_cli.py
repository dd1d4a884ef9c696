import importlib
import inspect
import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace
from typing import Literal

import pytest

from jaxleas import cli
from jaxleas.cli_guard import UsageError, run_guarded
from jaxleas.configuration import Allow
from jaxleas.types.errors import InputError, JaxleasError


def walk(
    policy: str | Path,
    *,
    out: Path,
    starts: int = 1000,
    suite: Literal["hole", "wall"] = "hole",
    yaw: float | None = None,
    origin: tuple[float, float] = (0.0, 0.0),
    seeds: tuple[int, ...] = (),
    verbose: bool = False,
    json: Path | None = None,
) -> None:
    """Walk a policy.

    Args:
        policy: run folder
            or file, 100 % sure.
        out: where to write.
        starts: how many.
        suite: of terrains.
        yaw: [deg].
        origin: [m].
        seeds: of the terrains.
        verbose: say more.
        json: results.

    Raises:
        InputError: never a help text.
    """
    CALLS.append(dict(locals()))


CALLS: list[dict] = []


@pytest.fixture(autouse=True)
def walk_command(monkeypatch) -> None:
    CALLS.clear()
    rooms = {"room": SimpleNamespace(walk=walk)}
    monkeypatch.setattr(cli, "COMMANDS", {**cli.COMMANDS, "gait amble": ("room", "walk", "walk")})
    find = cli.import_module
    monkeypatch.setattr(cli, "import_module", lambda name: rooms.get(name) or find(name))


def refusal(*arguments: str) -> str:
    with pytest.raises(UsageError) as caught:
        cli.run(arguments)
    assert "\n" not in str(caught.value)
    return str(caught.value)


def test_options_follow_the_signature() -> None:
    least = "gait amble runs/one --out G.npz"
    most = f"{least} --starts 5 --suite wall --yaw -3.5 --origin 1 -2 --seeds 1 2 3 --verbose"
    for line in (least, f"{most} --json=x.json"):
        cli.run(line.split())
    plain = {
        "policy": Path("runs/one"),
        "out": Path("G.npz"),
        "starts": 1000,
        "suite": "hole",
        "yaw": None,
        "origin": (0.0, 0.0),
        "seeds": (),
        "verbose": False,
        "json": None,
    }
    chosen = {
        "starts": 5,
        "suite": "wall",
        "yaw": -3.5,
        "origin": [1.0, -2.0],
        "seeds": [1, 2, 3],
        "verbose": True,
        "json": Path("x.json"),
    }
    first, second = CALLS
    assert first == plain
    assert second == {**plain, **chosen}


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("evalute RUN", ["no command 'evalute'", "meant 'evaluate'"]),
        ("terrain shwo x", ["no command 'terrain shwo'", "meant 'terrain show'"]),
        ("terain show x", ["no command 'terain'", "meant 'terrain show'"]),
        ("terain", ["no command 'terain'", "meant 'train'"]),
        ("qqqq", ["no command 'qqqq'", "there are train, terrain show, "]),
        ("gait amble p --out x --strats 3", ["has no --strats, perhaps you meant --starts"]),
        ("gait amble p --out x --start 3", ["perhaps you meant --starts"]),
        ("gait amble p --out x more", ["takes no further argument 'more'; see"]),
        ("gait amble p", ["required: --out"]),
        ("gait amble --out x", ["required: POLICY"]),
        ("gait amble p --out x --starts many", ["--starts: invalid int value: 'many'"]),
        ("gait amble p --out x --suite bridge", ["invalid choice: 'bridge'", "hole", "wall"]),
        ("gait amble p --out", ["--out: expected one argument"]),
    ],
)
def test_a_mistake_is_one_sentence_with_the_nearest(line: str, expected: list[str]) -> None:
    sentence = refusal(*line.split())
    assert all(part in sentence for part in expected), sentence
    assert not CALLS


def test_a_second_file_is_perhaps_the_output() -> None:
    """As with `cp`: people write the file to make behind the file to read."""
    assert "perhaps you meant --out b.png" in refusal("terrain", "convert", "a.npz", "b.png")


def test_an_option_of_several_values_may_be_given_several_times() -> None:
    cli.run(["gait", "amble", "p", "--out", "x", "--seeds", "1", "2", "--seeds", "3"])
    assert CALLS[0]["seeds"] == [1, 2, 3]


LOAD_NO_CODE = {
    *("terrain show", "terrain convert", "terrain surfaces"),
    *("terrain generate", "terrain scenario"),
    *(
        "plan",
        "check",
        "contacts",
        "contacts export",
        "label",
    ),  # a planner is named on the command line itself
    *(
        "runs",
        "compare",
        "gait fit",
        "gait footsteps",
        "gait plan",
        "gait track",
        "gait imitate",
        "gait course",
        "transition check",
        "robot make",
    ),  # plain
}


@pytest.mark.parametrize("name", sorted(set(cli.COMMANDS) - LOAD_NO_CODE))
def test_every_command_that_reads_a_policy_takes_the_same_option_for_code(name: str) -> None:
    module, function, _ = cli.COMMANDS[name]
    signature = inspect.signature(getattr(importlib.import_module(module), function))
    allow = signature.parameters["allow"]
    assert (allow.annotation, allow.default) == (Allow, ())


@pytest.mark.parametrize("name", ["level_ground", "level_ground.LevelGround", ":LevelGround", "a:"])
def test_the_option_for_code_takes_a_module_and_a_class(name: str) -> None:
    with pytest.raises(InputError, match="is no MODULE:CLASS"):
        cli.run(["export", "run", "--allow", name])


TAILS = ("of ", "by ", "in ", "on ", "with ", "from ", "to ", "at ", "as ", "the same ")


@pytest.mark.parametrize("name", [each for each in cli.COMMANDS if each != "gait amble"])
def test_every_option_is_explained_by_a_phrase_that_stands_alone(name: str) -> None:
    module, function, _ = cli.COMMANDS[name]
    parser = cli._Parser(prog=name)
    cli.add_options(parser, getattr(importlib.import_module(module), function))
    helps = {action.dest: action.help or "" for action in parser._actions}
    assert [dest for dest, text in helps.items() if len(text) < 10 or text.startswith(TAILS)] == []


def test_help_comes_from_the_docstring(capsys) -> None:
    with pytest.raises(SystemExit) as caught:
        cli.run(["gait", "amble", "--help"])
    text = " ".join(capsys.readouterr().out.split())
    assert caught.value.code == 0
    assert "Walk a policy." in text
    assert "run folder or file, 100 % sure." in text
    assert "how many. [1000]" in text
    assert "never a help text" not in text


@pytest.mark.parametrize("line", ["", "--help", "-h", "terrain", "terrain --help"])
def test_the_overview_lists_every_command(capsys, line: str) -> None:
    cli.run(line.split())
    text = capsys.readouterr().out
    assert all(f"  {name}" in text for name in cli.COMMANDS)


def test_version(capsys) -> None:
    cli.run(["--version"])
    assert capsys.readouterr().out.startswith("jaxleas 0.")


def test_every_command_exists() -> None:
    import importlib

    for module, function, _ in cli.COMMANDS.values():
        if module != "room":
            assert callable(getattr(importlib.import_module(module), function))


def guarded(error: BaseException, monkeypatch, *arguments: str) -> int:
    monkeypatch.setattr(sys, "argv", ["/usr/bin/jaxleas", *arguments])

    def fail() -> None:
        raise error

    return run_guarded(fail)


class StoppedError(JaxleasError):
    exit_code = 130


@pytest.mark.parametrize(
    ("error", "code", "words"),
    [
        (InputError("x.yaml:\n no key"), 2, "jaxleas: x.yaml: no key\n"),
        (UsageError("no command"), 2, "jaxleas: no command\n"),
        (OSError(28, "No space left on device", "x.npz"), 2, "No space left on device: 'x.npz'"),
        (OSError(36, "File name too long", "a" * 300), 2, "File name too long"),
        (PermissionError(13, "Permission denied", "x.npz"), 2, "Permission denied: 'x.npz'"),
        (StoppedError("stopped"), 130, "jaxleas: stopped\n"),
        (KeyboardInterrupt(), 130, ""),
    ],
)
def test_an_error_becomes_a_sentence_and_a_code(capsys, monkeypatch, error, code, words) -> None:
    monkeypatch.delenv("JAXLEAS_TRACEBACK", raising=False)
    assert guarded(error, monkeypatch) == code
    text = capsys.readouterr().err
    assert words in text
    assert bool(words) == bool(text)


def test_a_bug_keeps_its_traceback(monkeypatch) -> None:
    monkeypatch.delenv("JAXLEAS_TRACEBACK", raising=False)
    with pytest.raises(ZeroDivisionError):
        guarded(ZeroDivisionError(), monkeypatch)
    with pytest.raises(FileNotFoundError):
        guarded(FileNotFoundError(), monkeypatch)


def test_a_traceback_can_be_asked_for(monkeypatch) -> None:
    monkeypatch.delenv("JAXLEAS_TRACEBACK", raising=False)
    with pytest.raises(InputError):
        guarded(InputError("x"), monkeypatch, "evaluate", "--traceback")
    assert sys.argv[1:] == ["evaluate"]
    monkeypatch.setenv("JAXLEAS_TRACEBACK", "1")
    with pytest.raises(InputError):
        guarded(InputError("x"), monkeypatch)


def command(*arguments: str) -> subprocess.CompletedProcess[str]:
    code = "import sys; from jaxleas.cli import main; sys.argv[0] = 'jaxleas'; main()"
    return subprocess.run(
        [sys.executable, "-c", code, *arguments],
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "JAXLEAS_TRACEBACK": ""},
    )


def test_a_whole_process_answers_with_one_line_and_two() -> None:
    done = command("evalute")
    assert done.returncode == 2
    assert done.stdout == ""
    assert done.stderr == "jaxleas: there is no command 'evalute'; perhaps you meant 'evaluate'\n"


def test_help_loads_nothing_heavy() -> None:
    code = (
        "import sys; from jaxleas.cli import run; run(['--help'])\n"
        "heavy = {'jax', 'numpy', 'pydantic', 'matplotlib', 'mujoco'} & sys.modules.keys()\n"
        "assert not heavy, heavy"
    )
    subprocess.run([sys.executable, "-c", code], check=True, capture_output=True)


@dataclass(frozen=True)
class Shoes:
    """What is worn.

    Attributes:
        size: length of the sole [cm].
        laces: whether they have laces.
    """

    size: float = 27.0
    laces: bool = True


def stroll(policy: Path, *, shoes: Shoes = Shoes(), steps: int = 3) -> Shoes:
    """Stroll.

    Args:
        policy: run folder.
        shoes: what is worn.
        steps: number of steps.
    """
    CALLS.append(dict(locals()))
    return shoes  # a value of named fields that is returned is no option


def test_a_value_of_named_fields_is_one_option_per_field(monkeypatch, capsys):
    rooms = {"room": SimpleNamespace(stroll=stroll)}
    monkeypatch.setattr(cli, "COMMANDS", {"stroll": ("room", "stroll", "stroll")})
    monkeypatch.setattr(cli, "import_module", rooms.__getitem__)
    cli.run(["stroll", "run", "--size", "25.5", "--no-laces"])
    cli.run(["stroll", "run", "--steps", "4"])
    assert [
        {"policy": Path("run"), "shoes": Shoes(25.5, laces=False), "steps": 3},
        {"policy": Path("run"), "shoes": Shoes(), "steps": 4},
    ] == CALLS
    with pytest.raises(SystemExit):
        cli.run(["stroll", "--help"])
    shown = capsys.readouterr().out
    assert "--size" in shown
    assert "length of the sole [cm]. [27.0]" in shown
    assert "--shoes" not in shown
