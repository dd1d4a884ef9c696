"""A page on which an exported policy walks: static files, for any web host."""

from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np

from jaxleas.envs.steering import SteeringConfig, SteeringEnv, describe_steering, layout_named
from jaxleas.files import write_bytes, write_json
from jaxleas.guide import choose_start, read_onnx_policy, require_start
from jaxleas.robots import Robot
from jaxleas.terrain import HeightMap
from jaxleas.types import InputError, RootPose
from jaxleas.viewer.web_runtime import RUNTIME_FILES, runtime_folder

SOURCES = ("walk.js", "page.js", "page.css", "index.html")
MOST_CELLS = 4_000_000
"""Maximum number of cells of the terrain: a visitor downloads four bytes per cell."""


def page_of(
    folder: Path,
    file: Path,
    terrain: HeightMap,
    start: tuple[float, float, float] | None,
    runtime: Path | None,
) -> None:
    """Write the page of an ONNX file (`write_page`)."""
    config = read_onnx_policy(file).config
    write_page(folder, file.read_bytes(), config, terrain, start, runtime)


def write_page(
    folder: str | Path,
    policy: bytes,
    config: SteeringConfig,
    terrain: HeightMap,
    start: tuple[float, float, float] | None = None,
    runtime: Path | None = None,
) -> None:
    """Write the page, whose `index.html` opens through any web server.

    Args:
        folder: folder to write about ten files to, one of them onnxruntime (14 MB).
        policy: content of an ONNX file.
        config: configuration of the policy's environment.
        terrain: height map to walk on.
        start: start x, y [m] and heading [deg]; by default a place with room around it.
        runtime: the `dist` folder of onnxruntime-web, to use instead of fetching it with npm.

    Raises:
        InputError: the terrain is too large or the start invalid, the page cannot make the policy's
            observation, or a file cannot be written.
    """
    layout = layout_named(config.observation)
    if layout.counts_surfaces or layout.feelers:
        what = "count surfaces" if layout.counts_surfaces else "feel margins"
        raise InputError(
            f"a page does not {what}, as the observation {config.observation} asks for:"
            " export a policy of another layout"
        )
    if terrain.heights.size > MOST_CELLS:
        raise InputError(
            f"a terrain of {terrain.heights.size} cells is too large for a page, which takes"
            f" {MOST_CELLS}; import it at a coarser --resolution"
        )
    # The page judges by no condition; R* and C choose where to start, and need no other file.
    env = SteeringEnv(config.under_standard_conditions())
    pose = choose_start(env, terrain) if start is None else require_start(env, terrain, start)
    library = runtime_folder(runtime)
    folder = Path(folder)
    for name in RUNTIME_FILES:
        write_bytes(folder / name, (library / name).read_bytes())
    write_bytes(folder / "policy.onnx", policy)
    write_bytes(folder / "heights.bin", terrain.heights.astype("<f4").tobytes())
    write_json(folder / "page.json", page_description(config, env.robot, terrain, pose))
    for name in SOURCES:  # index.html last: a page that opens is complete
        write_bytes(folder / name, (resources.files("jaxleas.viewer") / "page" / name).read_bytes())


def page_description(
    config: SteeringConfig, robot: Robot, terrain: HeightMap, start: RootPose
) -> dict[str, Any]:
    """Return the description of the page for its scripts, which `page.json` holds."""
    stated = describe_steering(config)
    low = np.min([box.low for box in robot.trunk], axis=0)
    high = np.max([box.high for box in robot.trunk], axis=0)
    rows, columns = terrain.shape
    return {
        "observation": stated["observation"],
        "command": stated["command"],
        "guard": stated.get("guard"),
        "robot": robot.name,
        "walking_height": robot.walking_height,
        "goal_radius": config.goal_radius,
        "trunk": [low[:2].tolist(), high[:2].tolist()],
        "start": {"position": start.position[:2].tolist(), "yaw": float(start.yaw)},
        "terrain": {
            "rows": rows,
            "columns": columns,
            "resolution": terrain.resolution,
            "origin": list(terrain.origin),
        },
    }
