"""The page's JavaScript computes what the environment computes, in node and in a real browser."""

import json
import shutil
import subprocess
import tarfile
from importlib import resources

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxleas.envs.steering import SteeringConfig
from jaxleas.envs.steering.config import GuardConfig
from jaxleas.envs.steering.env import SteeringEnv
from jaxleas.envs.steering.motion import integrate
from jaxleas.export import build_onnx
from jaxleas.export.commands import export
from jaxleas.export.write import described
from jaxleas.guide.commands import walk_queries
from jaxleas.guide.leas import leas
from jaxleas.terrain import HeightMap, write_height_map
from jaxleas.terrain.atlas import make_atlas
from jaxleas.types import InputError, Query, RootMotion, RootPose
from jaxleas.viewer import web_runtime
from jaxleas.viewer.web_page import page_description, write_page
from jaxleas.viewer.web_runtime import RUNTIME_FILES, kept_runtime, runtime_folder
from tests.browser import chromium, served
from tests.guide.walkers import flat_map, random_policy, small_arena

POLICY = random_policy(seed=4)
ENV = SteeringEnv(POLICY.config)
GUARDED = SteeringEnv(SteeringConfig(guard=GuardConfig(enabled=True)))
ONNX = build_onnx(POLICY, described(POLICY.config))
STEPS = 200

REPLAY = """
import { readFileSync } from "node:fs";
const { Terrain, observe, integrate, guarded } = await import(process.argv[2]);
const { task, heights, motion, goal, commands } = JSON.parse(readFileSync(0, "utf8"));
const terrain = new Terrain(task.terrain, heights.map((each) => each ?? NaN));
let now = motion;
const seen = [], walked = [];
for (const command of commands) {
  seen.push(Array.from(observe(task, terrain, now, goal)));
  now = guarded(task, terrain, now, integrate(task, now, command));
  walked.push([...now.position, ...now.velocity, now.yaw]);
}
console.log(JSON.stringify({ seen, walked }));
"""
WALK = """
const [goal, steps, done] = arguments;
(async () => {
  const { Terrain, stand, step } = await import("./walk.js");
  const ort = await import("./ort.wasm.bundle.min.mjs");
  ort.env.wasm.numThreads = 1;
  const task = await (await fetch("page.json")).json();
  const heights = new Float32Array(await (await fetch("heights.bin")).arrayBuffer());
  const terrain = new Terrain(task.terrain, heights);
  const session = await ort.InferenceSession.create("policy.onnx");
  let now = stand(task, terrain, task.start.position, task.start.yaw);
  const walked = [];
  for (let index = 0; index < steps; index++) {
    now = await step(ort, session, task, terrain, now, goal);
    walked.push([...now.position, ...now.velocity, now.yaw]);
  }
  done(walked);
})().catch((problem) => done(String(problem)));
"""


def hills() -> HeightMap:
    """Smooth ground with a hole and a ledge far from any cell's edge that the robot meets."""
    level = flat_map(half_size=8.0, resolution=0.04)
    x, y = np.meshgrid(*2 * [np.linspace(-8.0, 8.0, level.shape[0])])
    heights = (0.05 * np.sin(1.3 * x) * np.cos(0.9 * y)).astype(np.float32)
    heights[(np.abs(x - 2.6) < 0.4) & (np.abs(y - 1.2) < 0.4)] = np.nan
    return HeightMap(heights, level.resolution, level.origin)


@pytest.mark.skipif(shutil.which("node") is None, reason="no node here")
@pytest.mark.parametrize(
    ("terrain", "env"),
    [(hills(), ENV), (small_arena()[1], ENV), (hills(), GUARDED), (small_arena()[1], GUARDED)],
    ids=["hills", "arena", "hills, guarded", "arena, guarded"],
)
def test_javascript_observes_and_moves_as_the_environment(terrain, env, tmp_path):
    rng = np.random.default_rng(0)
    commands = jnp.asarray(rng.uniform(-0.08, 0.08, (STEPS, 4)) * [1, 1, 0.1, 2], jnp.float32)
    x_min, _, y_min, _ = terrain.extent
    place = (x_min + 1.7, y_min + 1.6)
    motion = RootMotion(
        position=jnp.asarray([[*place, 0.9]], jnp.float32),
        velocity=jnp.asarray([[0.05, 0.02, 0.0]], jnp.float32),
        yaw=jnp.asarray([2.9], jnp.float32),
    )
    goal = (place[0] - 3.0, place[1] + 0.4)
    seen, walked = replay(env, terrain, motion, goal, commands)
    task = page_description(env.config, env.robot, terrain, RootPose.from_yaw(np.zeros(3), 0.0))
    answer = in_node(
        {
            "task": task,
            "heights": [None if np.isnan(each) else float(each) for each in terrain.heights.flat],
            "motion": {
                "position": np.asarray(motion.position[0]).tolist(),
                "velocity": np.asarray(motion.velocity[0]).tolist(),
                "yaw": float(motion.yaw[0]),
            },
            "goal": goal,
            "commands": np.asarray(commands).tolist(),
        },
        tmp_path,
    )
    gap = np.abs(np.array(answer["walked"]) - walked)
    gap[:, 6] = np.minimum(gap[:, 6], 2 * np.pi - gap[:, 6])  # of yaws
    assert gap.max() < 1e-4
    difference = np.abs(np.array(answer["seen"]) - seen)
    assert difference[:, :4].max() < 1e-4
    # A grid point within rounding of a cell's edge may see its neighbour: a handful of 28,000.
    assert (difference[:, 4:] > 1e-4).mean() < 1e-3


def replay(env, terrain, motion, goal, commands):
    """Return what the environment sees and does under given commands."""
    atlas, index = make_atlas([terrain]), jnp.zeros(1, jnp.int32)
    target = jnp.asarray([goal], jnp.float32)

    def step(now, command):
        seen = env.observe(env.local_heights(atlas, index, now), now, target)
        after = integrate(now, command[None], env.config.limits)
        if env.guard is not None:
            after = env.guard(atlas, index, now, after)
        row = jnp.concatenate([after.position[0], after.velocity[0], after.yaw])
        return after, (seen[0], row)

    _, (seen, walked) = jax.jit(lambda: jax.lax.scan(step, motion, commands))()
    return np.asarray(seen), np.asarray(walked)


def in_node(given, tmp_path):
    script = tmp_path / "replay.mjs"
    script.write_text(REPLAY, encoding="utf-8")
    module = tmp_path / "walk.mjs"  # node takes a lone .js for CommonJS
    module.write_bytes((resources.files("jaxleas.viewer") / "page" / "walk.js").read_bytes())
    done = subprocess.run(
        ["node", str(script), str(module)],
        input=json.dumps(given, allow_nan=False),
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


@pytest.mark.slow
def test_the_page_walks_where_the_roll_out_walks(tmp_path):
    if shutil.which("npm") is None and not kept_runtime().is_dir():
        pytest.skip("onnxruntime-web is not kept here, and there is no npm to fetch it")
    terrain, goal = hills(), (6.0, 3.0)
    write_page(tmp_path / "page", ONNX, POLICY.config, terrain, start=(-1.2, -0.4, 25.0))
    start = Query((-1.2, -0.4, height(terrain, (-1.2, -0.4))), np.radians(25.0), (0, 0, 0), goal)
    (expected,) = roll_out(terrain, start)
    assert len(expected) == STEPS  # it has not arrived: all steps are compared
    with served(tmp_path / "page") as address, chromium(tmp_path / "profile") as browser:
        browser.get(address)
        walked = browser.execute_async_script(WALK, goal, STEPS)
    assert isinstance(walked, list), walked
    gap = np.abs(np.array(walked)[:, :3] - expected)
    assert gap.max() < 1e-4
    assert np.ptp(expected[:, :2], axis=0).max() > 0.5  # and it went somewhere


def height(terrain, place):
    return float(terrain.height_at(np.array([place]))[0] + ENV.robot.walking_height)


def roll_out(terrain, start):
    fearless = SteeringEnv(POLICY.config, lambda _, motion: jnp.ones_like(motion.yaw))
    walked = walk_queries(fearless, leas(fearless, POLICY), terrain, [start], STEPS)
    end = np.asarray(walked.end)
    return [np.asarray(walked.position)[index, 1 : end[index] + 1] for index in range(len(end))]


@pytest.fixture
def runtime(tmp_path):
    """A folder that looks like the npm package's, for tests that run nothing."""
    folder = tmp_path / "dist"
    folder.mkdir()
    for name in RUNTIME_FILES:
        (folder / name).write_bytes(b"-")
    return folder


def test_the_command_writes_a_whole_page(tmp_path, runtime, capsys):
    (tmp_path / "policy.onnx").write_bytes(ONNX)
    write_height_map(tmp_path / "flat.npz", flat_map())
    page = tmp_path / "page"
    export(tmp_path / "policy.onnx", page=page, terrain=tmp_path / "flat.npz", runtime=runtime)
    assert "http.server" in capsys.readouterr().out
    assert (page / "policy.onnx").read_bytes() == ONNX
    task = json.loads((page / "page.json").read_text())
    stored = np.frombuffer((page / "heights.bin").read_bytes(), "<f4")
    assert stored.size == task["terrain"]["rows"] * task["terrain"]["columns"]
    assert task["observation"]["size"] == ENV.layout.size
    for name in ("index.html", "page.js", "page.css", "walk.js", *RUNTIME_FILES):
        assert (page / name).is_file()
    sources = "".join((page / name).read_text() for name in ("index.html", "page.js", "walk.js"))
    assert "http" not in sources  # it asks nobody else for anything


def test_bad_input_writes_no_page(tmp_path, runtime):
    (tmp_path / "policy.onnx").write_bytes(ONNX)
    write_height_map(tmp_path / "flat.npz", flat_map())
    given = {"page": tmp_path / "page", "terrain": tmp_path / "flat.npz"}
    with pytest.raises(InputError, match="both --page DIR and --terrain"):
        export(tmp_path / "policy.onnx", page=tmp_path / "page")
    with pytest.raises(InputError, match="nearest valid place"):
        export(tmp_path / "policy.onnx", **given, start=(9.0, 0.0, 0.0), runtime=runtime)
    (runtime / RUNTIME_FILES[0]).unlink()
    with pytest.raises(InputError, match=f"lacks {RUNTIME_FILES[0]}"):
        export(tmp_path / "policy.onnx", **given, runtime=runtime)
    assert not (tmp_path / "page").exists()


def test_a_runtime_that_is_not_the_published_one_is_refused(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setattr(web_runtime.shutil, "which", lambda _: None)
    with pytest.raises(InputError, match="no npm here"):
        runtime_folder()
    package = tmp_path / "forged.tgz"
    with tarfile.open(package, "w:gz"):
        pass
    with pytest.raises(InputError, match="is not the onnxruntime-web"):
        web_runtime._unpack(package, kept_runtime())
    assert not kept_runtime().exists()
