"""LEAS and its conditions in plain NumPy, one robot at a time, sharing no code with JAX's."""

import math

import numpy as np

from jaxleas.training.networks.mlp import layers_of

LAYOUT_ROWS = [-0.425, -0.255, -0.085, 0.075, 0.225, 0.375, 0.525, 0.675, 0.825, 0.975]
LAYOUT_COLUMNS = [0.09 * (index - 6.5) for index in range(14)]
TRUNK_X = np.linspace(-0.2, 0.133, 4)
TRUNK_Y = np.linspace(-0.3, 0.3, 7)
SEAM = 3e-6  # [m]: float32 cannot tell on which side of a cell's edge a point lies


class Twin:
    def __init__(self, policy, robot, terrain):
        self.policy, self.robot, self.terrain = policy, robot, terrain

    def heights(self, points, position, yaw):
        """Heights relative to the root under points of the root frame; -inf over the void."""
        world = [
            [
                position[0] + x * math.cos(yaw) - y * math.sin(yaw),
                position[1] + x * math.sin(yaw) + y * math.cos(yaw),
            ]
            for x, y in points
        ]
        height = self.terrain.height_at(np.array(world)).astype(float)
        return np.where(np.isnan(height), -math.inf, height - float(position[2]))

    def step(self, position, velocity, yaw, goal):
        """The next configuration: T eq. 3.1 to 3.3."""
        limits = self.policy.config.limits
        yaw = float(yaw)
        turn = np.array([[math.cos(yaw), -math.sin(yaw)], [math.sin(yaw), math.cos(yaw)]])
        position, velocity = np.asarray(position, float), np.asarray(velocity, float)
        grid = [(x, y) for x in LAYOUT_ROWS for y in LAYOUT_COLUMNS]
        angle = math.atan2(goal[1] - position[1], goal[0] - position[0]) - yaw
        observation = [
            *(turn.T @ velocity[:2]),
            velocity[2],
            math.remainder(angle, 2 * math.pi),
            *np.clip(self.heights(grid, position, yaw), -1.4, -0.2),
        ]
        acceleration, rate = self.command(np.array(observation))
        new_velocity = velocity + limits.time_step * np.append(
            turn @ acceleration[:2], acceleration[2]
        )
        speed = np.linalg.norm(new_velocity)
        if speed > limits.max_speed:
            new_velocity *= limits.max_speed / speed
        return position + velocity * limits.time_step, new_velocity, yaw + rate * limits.time_step

    def command(self, observation):
        limits = self.policy.config.limits
        value = (observation - np.asarray(self.policy.mean)) / np.asarray(self.policy.deviation)
        value = np.minimum(np.maximum(value, -10), 10)
        layers = layers_of(self.policy.params)
        last = len(layers) - 1
        for index in range(last + 1):
            value = np.asarray(layers[index][0], float).T @ value
            value = value + np.asarray(layers[index][1], float)
            if index < last:
                value = np.where(value > 0, value, 0.0)
        action = np.tanh(value[:4])
        length = np.linalg.norm(action[:3])
        direction = action[:3] / max(1.0, length)
        return limits.max_acceleration * direction, limits.max_turn_rate * action[3]

    def is_valid(self, position, yaw):
        """R*: a point under the root that a leg reaches; C: nothing inside or above the trunk."""
        trunk = [(x, y) for x in TRUNK_X for y in TRUNK_Y]
        under = self.heights(trunk, position, float(yaw))
        if (under > -0.628).any():
            return False
        grid = [(x, y) for x in LAYOUT_ROWS for y in LAYOUT_COLUMNS] + trunk
        near = [(x, y) for x, y in grid if max(abs(x), abs(y)) <= 0.1 + 1e-9]
        for (x, y), height in zip(near, self.heights(near, position, float(yaw)), strict=True):
            for limb in self.robot.limbs:
                shape = limb.range_of_motion
                if math.isfinite(height) and np.all(
                    shape.normals @ [x, y, height] <= shape.offsets
                ):
                    return True
        return False

    def is_ambiguous(self, position, velocity, yaw):
        """Does a point lie on the seam of cells of different height?"""
        grid = [(x, y) for x in LAYOUT_ROWS for y in LAYOUT_COLUMNS]
        grid += [(x, y) for x in TRUNK_X for y in TRUNK_Y]
        middle = self.heights(grid, position, float(yaw))
        for shift in ((SEAM, 0), (-SEAM, 0), (0, SEAM), (0, -SEAM)):
            moved = np.asarray(position, float) + np.array([*shift, 0.0])
            if not np.array_equal(self.heights(grid, moved, float(yaw)), middle):
                return True
        return False
