"""All sequences of commands, one by one, in plain loops: the twin of the velocity A*."""

import math

from jaxleas.footsteps import FootCostMap, Goal, MotionModel, WalkingState


def best_cost(
    model: MotionModel,
    costs: FootCostMap,
    state: WalkingState,
    goal: Goal,
    horizon: int,
    clearance: float,
) -> float:
    """Return the least cost of all plans that reach the goal or the horizon; infinity if none."""
    cos, sin = math.cos(state.yaw), math.sin(state.yaw)
    vx, vy, vz = state.com_velocity
    velocity = [cos * vx + sin * vy, -sin * vx + cos * vy, vz, state.yaw_rate]
    heights = [height_of(costs, x, y) for x, y, _ in state.feet]
    feet = [
        [x, y, z if math.isnan(height) else height]
        for (x, y, z), height in zip(state.feet, heights, strict=True)
    ]
    start = (list(state.com[:2]), state.yaw, velocity, feet, state.pair, list(state.command))
    strides = strides_of(model)
    return _least(model, costs, start, goal, horizon, clearance, strides)


def _least(model, costs, start, goal, horizon, clearance, strides):
    com, yaw, *_ = start
    if horizon == 0 or _is_there(com, yaw, goal):
        return _left(model, com, yaw, goal, strides)
    least = math.inf
    for command in model.commands().tolist():
        stepped = step(model, costs, start, command)
        if stepped is not None:
            after, near = stepped
            rest = _least(model, costs, after, goal, horizon - 1, clearance, strides)
            least = min(least, 1.0 + clearance * near + rest)
    return least


def _is_there(com, yaw, goal):
    apart = math.hypot(com[0] - goal.x, com[1] - goal.y)
    return apart <= goal.distance and abs(_angle(goal.yaw - yaw)) <= goal.angle


def _angle(angle):
    return math.remainder(angle, 2 * math.pi)


def _left(model, com, yaw, goal, strides):
    """Return about how many footsteps are left: straight as it stands, or turned to the goal."""
    ahead, aside, turn, back = strides
    apart = math.hypot(com[0] - goal.x, com[1] - goal.y)
    left, error = max(apart - goal.distance, 0.0), abs(_angle(goal.yaw - yaw))
    at_least = max(left / model.longest_stride, (error - goal.angle) / model.largest_turn, 0.0)
    bearing = _angle(math.atan2(goal.y - com[1], goal.x - com[0]) - yaw)
    error = max(error - goal.angle, 0.0)
    if left == 0.0:
        return max(error / turn, at_least)
    along = left * math.cos(bearing)
    straight = (along / ahead if along >= 0.0 else -along / back) + abs(
        left * math.sin(bearing) / aside
    )
    finish = max(abs(_angle(goal.yaw - yaw - bearing)) - goal.angle, 0.0)
    around = abs(bearing) / turn + left / ahead + finish / turn
    return max(min(straight + error / turn, around), at_least)


def strides_of(model):
    """Return what a footstep leads to at most when one command holds: ahead, aside, turned."""
    found = {(axis, sign): [0.0] for axis in range(3) for sign in (1, -1)}
    for command in model.commands().tolist():
        com, yaw, velocity, previous = [0.0, 0.0], 0.0, [0.0] * 4, [0.0] * 3
        feet, moved = [[0.0, 0.0] for _ in model.controller.feet], []
        for number in range(12):
            pair = number % 2
            local = [each for foot in feet for each in _into(foot, com, yaw)]
            seen = [*command, *local, *previous, *velocity, 1.0]
            weights = model.weights[pair].tolist()
            out = [sum(w[k] * s for w, s in zip(weights, seen, strict=True)) for k in range(11)]
            after = _out_of(out[:2], com, yaw)
            for index, foot in enumerate(model.controller.pairs[pair]):
                landing = out[7 + 2 * index : 9 + 2 * index]
                base, angle = (
                    (after, yaw + out[2]) if model.feet == "relative" else (feet[foot], yaw)
                )
                feet[foot] = _out_of(landing, base, angle)
            com, yaw, velocity, previous = after, yaw + out[2], out[3:7], command
            moved.append(out[:3])
        steady = [(a + b) / 2 for a, b in zip(moved[-1], moved[-2], strict=True)]
        for axis, value in enumerate(command):
            if value:
                found[axis, int(math.copysign(1, value))].append(abs(steady[axis]))
    return (
        max(found[0, 1]),
        max(min(max(found[1, 1]), max(found[1, -1])), 1e-3),
        max(min(max(found[2, 1]), max(found[2, -1])), 1e-3),
        max(*found[0, -1], 1e-3),
    )


def _into(point, origin, yaw):
    dx, dy = point[0] - origin[0], point[1] - origin[1]
    return [
        math.cos(yaw) * dx + math.sin(yaw) * dy,
        -math.sin(yaw) * dx + math.cos(yaw) * dy,
    ]


def _out_of(vector, origin, yaw):
    return [
        origin[0] + math.cos(yaw) * vector[0] - math.sin(yaw) * vector[1],
        origin[1] + math.sin(yaw) * vector[0] + math.cos(yaw) * vector[1],
    ]


def step(model, costs, start, command):
    """Return the state after a footstep and its nearness to edges; None where it is refused."""
    com, yaw, velocity, feet, pair, previous = start
    cos, sin = math.cos(yaw), math.sin(yaw)
    local = []
    for x, y, _ in feet:
        dx, dy = x - com[0], y - com[1]
        local += [cos * dx + sin * dy, -sin * dx + cos * dy]
    seen = [*command, *local, *previous, *velocity, 1.0]
    weights = model.weights[pair].tolist()
    outputs = [sum(w[k] * s for w, s in zip(weights, seen, strict=True)) for k in range(11)]
    dx, dy, turn = outputs[:3]
    if math.hypot(dx, dy) > model.longest_stride or abs(turn) > model.largest_turn:
        return None
    next_com = [com[0] + cos * dx - sin * dy, com[1] + sin * dx + cos * dy]
    next_yaw = yaw + turn
    if distance_of(costs, *next_com) is None:
        return None
    next_feet, near = [list(foot) for foot in feet], 0.0
    for index, foot in enumerate(model.controller.pairs[pair]):
        u, v = outputs[7 + 2 * index : 9 + 2 * index]
        angle = next_yaw if model.feet == "relative" else yaw
        base = next_com if model.feet == "relative" else feet[foot][:2]
        x = base[0] + math.cos(angle) * u - math.sin(angle) * v
        y = base[1] + math.sin(angle) * u + math.cos(angle) * v
        distance = distance_of(costs, x, y)
        if distance is None or distance <= costs.buffer:
            return None
        z = height_of(costs, x, y)
        swing = model.controller.swing_height, model.controller.foot_radius
        if not abs(z - feet[foot][2]) <= model.controller.swing_height:
            return None
        if _hits(costs, feet[foot], (x, y, z), *swing):
            return None
        near += max(0.07 - distance, 0.0)
        next_feet[foot] = [x, y, z]
    after = (next_com, next_yaw, outputs[3:7], next_feet, 1 - pair, command)
    return after, near


def _hits(costs, lift, land, apex, radius):
    for part in (2, 4, 6, 8, *range(10, 18)):
        share = part / 18
        x, y, z = (a + share * (b - a) for a, b in zip(lift, land, strict=True))
        is_ball = land[2] < lift[2] and part > 9
        ground = _under_ball(costs, x, y, radius) if is_ball else height_of(costs, x, y)
        if ground > z + 4 * apex * share * (1 - share) - 0.01:
            return True
    return False


def _under_ball(costs, x, y, radius):
    """Return how high the lowest point of a ball is that is lowered onto the cells around."""
    size, cell, highest = costs.height_map.resolution, _cell(costs, x, y), -math.inf
    if cell is None:
        return math.nan
    for row, heights in enumerate(costs.height_map.heights):
        for column, height in enumerate(heights.tolist()):
            apart = size * math.hypot(row - cell[0], column - cell[1])
            if apart <= radius and not math.isnan(height):
                highest = max(highest, height + math.sqrt(radius**2 - apart**2) - radius)
    return highest


def _cell(costs, x, y):
    size, (x0, y0) = costs.height_map.resolution, costs.height_map.origin
    column, row = math.floor((x - x0) / size + 0.5), math.floor((y - y0) / size + 0.5)
    rows, columns = costs.distance.shape
    return (row, column) if 0 <= row < rows and 0 <= column < columns else None


def distance_of(costs, x, y):
    cell = _cell(costs, x, y)
    return None if cell is None else float(costs.distance[cell])


def height_of(costs, x, y):
    cell = _cell(costs, x, y)
    return math.nan if cell is None else float(costs.height_map.heights[cell])
