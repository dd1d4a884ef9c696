"""What a user of pip gets: the wheel, in an environment and a folder that hold nothing else.

The libraries that it needs are those of the tests' own environment, from which it takes no jaxleas.
"""

import json
import os
import re
import subprocess
import sys
import sysconfig
import venv
from pathlib import Path

import pytest
import yaml

from benchmarks.tiny import tiny_training

ROOT = Path(__file__).resolve().parents[1]
pytestmark = pytest.mark.slow
QUERY = {"position": [0.7, 0.0, 0.95], "yaw": 0.0, "velocity": [0, 0, 0], "goal": [5.0, 0.0]}


@pytest.fixture(scope="module")
def installed(tmp_path_factory) -> Path:
    """The environment that the wheel is installed into."""
    wheels, target = tmp_path_factory.mktemp("wheels"), tmp_path_factory.mktemp("env")
    pip = [sys.executable, "-m", "pip"]
    options = ["--quiet", "--no-deps", "--no-index"]
    subprocess.run(
        [*pip, "wheel", *options, "--no-build-isolation", "--wheel-dir", wheels, ROOT], check=True
    )
    (wheel,) = wheels.glob("*.whl")
    venv.create(target, symlinks=True)
    python = target / "bin/python"
    subprocess.run([*pip, "--python", python, "install", *options, wheel], check=True)
    libraries = target / Path(sysconfig.get_path("purelib")).relative_to(sys.prefix)
    # A folder named in a .pth file is searched, but the .pth files in it do not count: that of the
    # editable jaxleas, say.
    (libraries / "libraries.pth").write_text(sysconfig.get_path("purelib"))
    return target / "bin"


@pytest.fixture
def user(installed: Path, tmp_path: Path, monkeypatch):
    """A function that runs a command in an empty folder and returns what it printed."""
    monkeypatch.chdir(tmp_path)
    without = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}

    def run(program: str, *arguments: str) -> str:
        done = subprocess.run(
            [installed / program, *arguments],
            capture_output=True,
            text=True,
            check=False,
            env=without,
        )
        assert done.returncode == 0, done.stderr
        return done.stdout

    return run


def test_the_command_answers_in_both_forms(user, installed: Path) -> None:
    where = user("python", "-c", "import jaxleas; print(jaxleas.__file__)")
    assert Path(where).is_relative_to(installed.parent)
    version = user("jaxleas", "--version")
    assert re.fullmatch(r"jaxleas \d+\.\d+\.\d+\n", version)
    assert user("python", "-m", "jaxleas", "--version") == version


def test_what_is_shipped_is_found_by_its_name(user) -> None:
    user("jaxleas", "terrain", "scenario", "stairs_up", "--out", "stairs.json")
    Path("queries.json").write_text(json.dumps([QUERY]))
    asked = ("--terrain", "stairs.json", "--queries", "queries.json", "--out", "paths.npz")
    assert "1 reached" in user("jaxleas", "rollout", "pretrained:leas_p1", *asked)
    view = ("--policies", "pretrained:leas_p1", "--start", "0.7", "0", "0", "--goal", "2", "0")
    user("jaxleas", "view", "stairs.json", *view, "--record", "walk.html")
    assert Path("walk.html").stat().st_size > 100_000
    user("jaxleas", "export", "pretrained:leas_p1")
    assert Path("leas_p1/policy.onnx").is_file()


def test_a_policy_is_trained(user) -> None:
    assert "--ppo.steps" in user("jaxleas", "train", "leas_p1", "--help")
    Path("mine.yaml").write_text(yaml.safe_dump(tiny_training(updates=2)))
    arguments = ["train", "mine.yaml", "--run-dir", "run", "--devices", "1", "--seed", "3"]
    user("jaxleas", *arguments)
    assert Path("run/policy.npz").is_file()
    told = json.loads(Path("run/provenance.json").read_text())["command"]
    assert told == ["jaxleas", *arguments]
