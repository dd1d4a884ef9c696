"""The example runs by itself, and walks where `jaxleas rollout` walks."""

import importlib.util
import re
import subprocess
import sys
from pathlib import Path

import jax.numpy as jnp
import numpy as np
import onnxruntime
import pytest

from jaxleas.envs.steering.config import GuardConfig
from jaxleas.envs.steering.env import SteeringEnv
from jaxleas.export import build_onnx
from jaxleas.export.write import described
from jaxleas.guide import Trips, leas, roll_out
from jaxleas.terrain import HeightMap, write_height_map
from jaxleas.terrain.atlas import make_atlas
from tests.guide.walkers import flat_map, random_policy, standing, waypoints_at

EXAMPLE = Path(__file__).resolve().parents[2] / "examples" / "drive_onnx.py"
GUARD = GuardConfig(enabled=True)
POLICIES = {
    "thesis144": random_policy(seed=4),
    "feelers169": random_policy(seed=4, observation="feelers169"),
    "guarded": random_policy(seed=4, guard=GUARD),
}


@pytest.fixture(params=POLICIES)
def policy(request):
    return POLICIES[request.param]


@pytest.fixture
def policy_file(policy, tmp_path):
    file = tmp_path / "policy.onnx"
    file.write_bytes(build_onnx(policy, described(policy.config)))
    return file


def test_it_runs_with_the_file_alone(policy_file, tmp_path):
    terrain = tmp_path / "map.npz"
    write_height_map(terrain, flat_map())
    for extra in ([], ["--terrain", str(terrain), "--goal", "1", "1"]):
        done = subprocess.run(
            [sys.executable, "-I", str(EXAMPLE), str(policy_file), "--steps", "30", *extra],
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 0, done.stderr
        assert re.fullmatch(
            r"30 steps, climbed [+-]\d\.\d\d m, \d\.\d\d m left to the goal\n", done.stdout
        )


def test_it_imports_neither_jax_nor_jaxleas():
    imported = set(re.findall(r"^(?:import|from) (\w+)", EXAMPLE.read_text(), re.MULTILINE))
    assert imported == {"argparse", "json", "numpy", "onnxruntime"}


def test_it_walks_where_the_roll_out_walks(policy, policy_file, tmp_path):
    spec = importlib.util.spec_from_file_location("drive_onnx", EXAMPLE)
    example = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(example)

    # A slope with a hole in it, smooth enough for float64 and float32 to stay together.
    level = flat_map()
    axis = np.arange(level.shape[0]) * level.resolution + level.origin[0]
    heights = np.broadcast_to(np.float32(0.0), level.shape).copy()
    heights[:, axis < -2.0] = np.nan
    terrain = HeightMap(heights, level.resolution, level.origin)
    file = tmp_path / "map.npz"
    write_height_map(file, terrain)

    env = SteeringEnv(policy.config)
    start = standing(env, [(-1.013, 0.517)])
    trips = Trips(make_atlas([terrain]), [0], start, waypoints_at(env, (2, 1)))
    rollout = roll_out(env, leas(env, policy), trips, 60)
    session = onnxruntime.InferenceSession(policy_file, providers=["CPUExecutionProvider"])
    start, goal = np.array([-1.013, 0.517]), np.array([2.0, 1.0])
    path = example.walk(session, example.height_map(file), start, goal, 60)
    end = int(rollout.end[0])
    assert end > 10
    np.testing.assert_allclose(path[: end + 1], rollout.position[0, : end + 1], atol=1e-4)
    assert jnp.asarray(path).shape == (61, 3)
