"""The rival, run in its own Python on the same task, and its measurements."""

import importlib.util
import json
import os
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from jaxleas.envs.steering import SteeringEnv, World
from jaxleas.files import read_json, write_npz
from jaxleas.types import InputError

ROOT = Path(__file__).resolve().parents[1]
MODULES = ("torch", "gymnasium", "stable_baselines3")
HOW = "install the extra `rivals`, or name a Python that has it: --rivals PYTHON"


def is_installed() -> bool:
    """Return whether this Python has the rival."""
    return all(importlib.util.find_spec(name) for name in MODULES)


def require_rival(python: str) -> None:
    """Require that a Python has the rival.

    Raises:
        InputError: the Python cannot be run, or lacks a package.
    """
    code = f"import importlib.util as u; print(*[n for n in {MODULES!r} if not u.find_spec(n)])"
    try:
        done = subprocess.run([python, "-c", code], capture_output=True, text=True, check=True)
    except (OSError, subprocess.CalledProcessError) as error:
        raise InputError(f"--rivals {python} cannot be run as a Python: {HOW}") from error
    if done.stdout.strip():
        missing = ", ".join(done.stdout.split())
        raise InputError(f"the rival cannot run: {python} has no {missing}; {HOW}")


class Rival:
    """Stable-Baselines3 in a separate process; each figure is measured on first use.

    Args:
        python: Python interpreter with the rival; None if there is none: then every figure is None.
        env: environment of the task.
        world: terrain of the task.
        runs: number of runs of each figure.
    """

    def __init__(self, python: str | None, env: SteeringEnv, world: World, runs: int) -> None:
        self.python, self._env, self._world, self._runs = python, env, world, runs
        self._known: dict[str, float] = {}

    def figure(self, name: str) -> float | None:
        """Return the median of one of `benchmarks.rivals.sb3`'s measures."""
        if self.python is None:
            return None
        if name not in self._known:
            self._known[name] = statistics.median(self._measure(name))
        return self._known[name]

    def _measure(self, name: str) -> list[float]:
        with tempfile.TemporaryDirectory() as folder:
            task, out = Path(folder) / "task.npz", Path(folder) / "out.json"
            write_task(task, self._env, self._world)
            words = [task, out, "--runs", self._runs, "--measure", name]
            done = subprocess.run(
                [str(self.python), "-m", "benchmarks.rivals.sb3", *map(str, words)],
                cwd=ROOT,
                env=os.environ | {"PYTHONPATH": str(ROOT), "PYTHONWARNINGS": "ignore"},
                capture_output=True,
                text=True,
                check=False,
            )
            if done.returncode:
                last = (done.stderr.strip().splitlines() or ["no message"])[-1]
                raise InputError(f"the rival failed to measure {name!r}: {last}")
            return read_json(out)[name]


def write_task(path: str | Path, env: SteeringEnv, world: World) -> None:
    """Write a task as plain numbers, for programs that share no code with this package."""
    constants: dict[str, Any] = {
        **env.config.model_dump(mode="json", exclude={"limits"}),
        **env.config.limits.model_dump(mode="json"),
        "rows": env.layout.rows,
        "columns": env.layout.columns,
        "resolution": world.atlas.resolution,
        "walking_height": env.robot.walking_height,
        "trunk": [{"low": list(box.low), "high": list(box.high)} for box in env.robot.trunk],
        "limbs": [
            {
                "normals": limb.range_of_motion.normals.tolist(),
                "offsets": limb.range_of_motion.offsets.tolist(),
            }
            for limb in env.robot.limbs
        ],
    }
    arrays = {
        "heights": world.atlas.heights,
        "origin": world.atlas.origin,
        "map_index": world.map_index,
        "start_area": world.start_area,
        "near_area": world.near_area,
        "goal_area": world.goal_area,
        "arena_area": world.arena_area,
        "share": world.cumulative_share,
    }
    plain = {name: np.asarray(value) for name, value in arrays.items()}
    write_npz(path, constants=np.array(json.dumps(constants)), **plain)


def default_python() -> str | None:
    """Return this Python if it has the rival."""
    return sys.executable if is_installed() else None
