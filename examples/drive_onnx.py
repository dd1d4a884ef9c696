"""Drive an exported policy with NumPy and onnxruntime alone: all it takes is in the file.

python examples/drive_onnx.py runs/leas_p1/policy.onnx [--terrain map.npz --goal X Y]
"""

import argparse
import json

import numpy as np
import onnxruntime


def stairs(x, y):
    """Terrain height [m]: five steps of 0.12 m, each 0.35 m deep, from x = 1 m on."""
    return 0.12 * np.clip(np.ceil((x - 1.0) / 0.35), 0, 5) + 0.0 * y


def height_map(path):
    """Terrain of a map: heights [row = y, column = x], resolution, origin [x, y] [m]."""
    file = np.load(path, allow_pickle=False)
    heights = np.pad(np.nan_to_num(file["heights"], nan=-1e4), 1, constant_values=-1e4)  # no ground

    def height(x, y):
        cells = np.stack([y, x]) - file["origin"][::-1].reshape(2, *[1] * np.ndim(x))
        row, column = np.rint(cells / file["resolution"]).astype(int) + 1
        return heights[row.clip(0, len(heights) - 1), column.clip(0, heights.shape[1] - 1)]

    return height


def feel(feelers, terrain, position, yaw):
    """Return the margin [m] of reach and room with the root moved, for each of the moves."""
    felt, keys = [], ("moves", "points", "reach", "free")
    for (ahead, left, turn), points, reach, free in zip(
        *(feelers[key] for key in keys), strict=True
    ):
        middle = position[:2] + (ahead, left) @ turned(yaw)
        height = terrain(*(middle + np.array(points) @ turned(yaw + turn)).T) - position[2]
        felt.append(margin_of({"reach": reach, "free": free}, height))
    return np.clip(felt, *feelers["clip"])


def margin_of(terms, height):
    """Return the margin [m] of reach and room from the heights [m] at the points they name."""
    on_ground = max(min(height[i] - low, high - height[i]) for i, low, high in terms["reach"])
    return min(on_ground, *(bottom - height[i] for i, bottom in terms["free"]))


def margins(guard, terrain, position, yaw):
    """Return the margins [m] of the guard's conditions, and of those with room to spare."""
    places = position[:2] + np.array(guard["points"]) @ turned(yaw)
    height = terrain(*places.T) - position[2]
    return margin_of(guard["valid"], height), margin_of(guard["spared"], height)


def can_stop(guard, room, bounds, terrain, position, velocity, yaw):
    """Return whether the root is valid here and wherever it would be while it braked to rest."""
    while True:
        valid, spared = margins(guard, terrain, position, yaw)
        if not (valid >= 0.0 and spared >= room):
            return False
        if not velocity.any():
            return True
        position, velocity = position + velocity * bounds["time_step"], slower(velocity, bounds)


def slower(velocity, bounds):
    """Return the velocity [m/s] after one time step of braking."""
    speed = np.linalg.norm(velocity)
    loss = bounds["max_acceleration"] * bounds["time_step"]
    return velocity * max(1.0 - loss / speed, 0.0) if speed > 0.0 else velocity


def upwards(velocity, rising, bounds):
    """Return the velocity [m/s] after one time step towards a vertical one."""
    change = np.array([0.0, 0.0, rising]) - velocity
    most = bounds["max_acceleration"] * bounds["time_step"]
    return velocity + change * min(1.0, most / max(np.linalg.norm(change), 1e-12))


def turned(yaw):
    """Return the matrix that turns points in rows by an angle [rad]."""
    return np.array([[np.cos(yaw), np.sin(yaw)], [-np.sin(yaw), np.cos(yaw)]])


def walk(session, terrain, start, goal, steps):
    """Return the root's positions [m] until it stands within 0.2 m of the goal."""
    metadata = session.get_modelmeta().custom_metadata_map
    layout, bounds, guard = (
        json.loads(metadata.get(key, "null")) for key in ("observation", "command", "guard")
    )
    grid = np.stack(np.meshgrid(layout["rows"], layout["columns"], [0.0], indexing="ij"), -1)
    profile = [[x, 0.0, 0.0] for x in layout.get("profile", [])]
    points = np.array([*grid.reshape(-1, 3), *profile])
    position, velocity, yaw = np.array([*start, terrain(*start) + 0.95]), np.zeros(3), 0.0
    path = [position]
    while len(path) <= steps and np.linalg.norm(goal - position[:2]) > 0.2:
        cosine, sine = np.cos(yaw), np.sin(yaw)
        to_world = np.array([[cosine, -sine, 0], [sine, cosine, 0], [0, 0, 1]])
        ahead, left = to_world.T[:2, :2] @ (goal - position[:2])
        x, y, _ = (points @ to_world.T + position).T
        heights = np.clip(terrain(x, y) - position[2], *layout["height_clip"])
        felt = feel(layout["feelers"], terrain, position, yaw) if "feelers" in layout else []
        observation = [*(to_world.T @ velocity), np.arctan2(left, ahead), *heights, *felt]
        (command,) = session.run(None, {"observation": np.array([observation], np.float32)})[0]
        position = position + velocity * bounds["time_step"]
        faster = velocity + to_world @ command[:3] * bounds["time_step"]
        faster /= max(1.0, np.linalg.norm(faster) / bounds["max_speed"])
        # What the guard does not let pass is tried without the turn, then upwards or downwards
        # alone; at last the root brakes.
        upright = upwards(velocity, faster[2], bounds)
        tried = [(faster, yaw + command[3] * bounds["time_step"]), (faster, yaw), (upright, yaw)]
        if guard:
            room = min(margins(guard, terrain, path[-1], yaw)[1], 0.0)
            tried = [one for one in tried if can_stop(guard, room, bounds, terrain, position, *one)]
        velocity, yaw = [*tried, (slower(velocity, bounds), yaw)][0]
        path.append(position)
    return np.array(path)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description="Walk an exported policy over a terrain.")
    parser.add_argument("policy", help="policy.onnx")
    parser.add_argument("--terrain", help="height map, .npz; by default five steps up")
    parser.add_argument("--start", type=float, nargs=2, default=(0.0, 0.0), metavar=("X", "Y"))
    parser.add_argument("--goal", type=float, nargs=2, default=(4.0, 0.0), metavar=("X", "Y"))
    parser.add_argument("--steps", type=int, default=800)
    given = parser.parse_args()
    session = onnxruntime.InferenceSession(given.policy, providers=["CPUExecutionProvider"])
    terrain = height_map(given.terrain) if given.terrain else stairs
    path = walk(session, terrain, np.array(given.start), np.array(given.goal), given.steps)
    left = np.linalg.norm(given.goal - path[-1, :2])
    climb = path[-1, 2] - path[0, 2]
    print(f"{len(path) - 1} steps, climbed {climb:+.2f} m, {left:.2f} m left to the goal")
