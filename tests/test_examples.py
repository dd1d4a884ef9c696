"""The short examples run as their first lines say, from another folder, and say what came of it."""

import re
import runpy
import subprocess
import sys
from pathlib import Path

import pytest

from jaxleas.terrain.commands import convert, scenario
from jaxleas.training.policy import write_policy
from tests.guide.walkers import homing_policy

EXAMPLES = Path(__file__).resolve().parents[1] / "examples"
SHORT = ("plan_in_mujoco", "footholds_on_grid_map", "train_on_mesh")


@pytest.fixture
def here(tmp_path: Path, monkeypatch) -> Path:
    monkeypatch.chdir(tmp_path)
    scenario("stairs_up", out=Path("stairs.json"))
    return tmp_path


def run(name: str, *arguments: str) -> str:
    command = [sys.executable, str(EXAMPLES / f"{name}.py"), *arguments]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout.splitlines()[-1]


@pytest.mark.parametrize("name", SHORT)
def test_an_example_is_read_in_a_minute(name: str) -> None:
    lines = (EXAMPLES / f"{name}.py").read_text(encoding="utf-8").splitlines()
    assert len(lines) <= 60
    assert f"python examples/{name}.py" in "\n".join(lines[:6])


@pytest.mark.slow
def test_a_plan_stands_in_mujoco(here: Path) -> None:
    pytest.importorskip("mujoco")
    said = run("plan_in_mujoco", "scene.xml")
    found = re.fullmatch(r"(\d+) footholds, at most (\d+\.\d) mm off the ground", said)
    assert found, said
    assert int(found[1]) > 10
    assert float(found[2]) < 1.0
    assert Path("scene.xml").read_text().count("<site") == int(found[1])


@pytest.mark.slow
def test_a_grid_map_becomes_footholds(here: Path) -> None:
    pytest.importorskip("rosbags")
    convert(Path("stairs.json"), out=Path("map.mcap"))
    places = ("--start", "0.9", "0", "--goal", "5", "0")
    said = run("footholds_on_grid_map", "map.mcap", *places, "--out", "footholds.csv")
    assert said.startswith("reached the goal: ")
    first, *rows = Path("footholds.csv").read_text().splitlines()
    assert first == "foot,surface,x,y,z"
    assert {row.partition(",")[0] for row in rows} == {"LF", "RF"}


@pytest.mark.slow
def test_a_mesh_is_trained_on(here: Path, monkeypatch, capsys) -> None:
    """The training itself, which takes minutes, is replaced by a policy that heads for its goal."""

    def replay(config, task, run, *_) -> None:
        assert config.terrain.files[0].file.endswith("stairs.stl")
        write_policy(run.path / "policy.npz", homing_policy())

    monkeypatch.setattr("jaxleas.training.train_task", replay)
    convert(Path("stairs.json"), out=Path("stairs.stl"))
    places = ("--start", "0.9", "0", "--goal", "1.5", "0")
    small = ("--terrain.arenas", "2", "--final.evaluate", "false")
    monkeypatch.setattr(sys, "argv", ["x.py", "stairs.stl", "--run-dir", "run", *places, *small])
    runpy.run_path(str(EXAMPLES / "train_on_mesh.py"), run_name="__main__")
    said = capsys.readouterr().out.splitlines()[-1]
    assert re.fullmatch(r"reached the goal on stairs\.stl in \d+\.\d\d m", said)
