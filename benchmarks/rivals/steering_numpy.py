"""The steering task in NumPy, in batches, in the usual form for Stable-Baselines3.

It shares no code with the JAX environment; a test compares the two.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from benchmarks.rivals.robot_numpy import footprint, reach_intervals, trunk_bottoms
from benchmarks.rivals.task import Task

GOALS = 4
NO_GROUND = -1.0e3
CANDIDATES = 256  # starts drawn and checked at once
HEIGHT_SPREAD = (-0.20, 0.07)


@dataclass
class Outcome:
    """The result of a step, one row per robot."""

    observation: np.ndarray
    reward: np.ndarray
    terminated: np.ndarray
    truncated: np.ndarray


class SteeringBatch:
    """A batch of robots that walk towards goals.

    Args:
        task: terrain, links and constants.
        count: number of robots.
        seed: random seed of starts and goals.
    """

    def __init__(self, task: Task, count: int, seed: int = 0) -> None:
        self.task, self.count = task, count
        self.random = np.random.default_rng(seed)
        constants = task.constants
        rows, columns = np.meshgrid(constants["rows"], constants["columns"], indexing="ij")
        grid = np.stack([rows.ravel(), columns.ravel()], axis=-1)
        points = np.concatenate([grid, footprint(constants["trunk"])])
        self.seen = len(grid)
        self.size = 4 + self.seen
        self.ahead, self.left = points.T.astype(np.float32)
        self.reach, self.reach_low, self.reach_high = reach_intervals(constants["limbs"], points)
        self.trunk, self.trunk_bottom = trunk_bottoms(constants["trunk"], points)
        self.position = np.zeros((count, 3), np.float32)
        self.velocity = np.zeros((count, 3), np.float32)
        self.yaw = np.zeros(count, np.float32)
        self.map = np.zeros(count, np.int32)
        self.goals = np.zeros((count, GOALS, 2), np.float32)
        self.goal_steps = np.zeros((count, GOALS), np.int32)
        self.goal_index = np.zeros(count, np.int32)
        self.goal_age = np.zeros(count, np.int32)
        self.steps = np.zeros(count, np.int32)
        self._spare: dict[str, np.ndarray] = {}
        self.restart(np.ones(count, bool))

    def observe(self) -> np.ndarray:
        """Return the current observation of every robot, in physical units."""
        return self._observation(self._heights(self.map, self.position, self.yaw))

    def step(self, action: np.ndarray) -> Outcome:
        """Advance every robot by one time step; finished ones are not restarted."""
        constants = self.task.constants
        command, effort, turn = self._command(action)
        time_step = constants["time_step"]
        cosine, sine = np.cos(self.yaw), np.sin(self.yaw)
        self.position += self.velocity * time_step
        change = command[:, :3].copy()
        change[:, 0] = cosine * command[:, 0] - sine * command[:, 1]
        change[:, 1] = sine * command[:, 0] + cosine * command[:, 1]
        self.velocity += change * time_step
        speed = np.sqrt(np.einsum("ni,ni->n", self.velocity, self.velocity))
        self.velocity /= np.maximum(1.0, speed / constants["max_speed"])[:, None]
        self.yaw = wrapped(self.yaw + command[:, 3] * time_step)

        heights = self._heights(self.map, self.position, self.yaw)
        valid = self._valid(heights)
        toward, distance = self._toward_goal()
        reward = self._reward(toward, effort, turn, valid)
        self._next_goals(distance <= constants["goal_radius"])
        self.steps += 1
        truncated = valid & (self.steps >= constants["episode_steps"])
        return Outcome(self._observation(heights), reward, ~valid, truncated)

    def restart(self, where: np.ndarray) -> None:
        """Give the robots in a mask fresh starts, each used once."""
        count = int(where.sum())
        while len(self._spare.get("yaw", ())) < count:
            fresh = self._draw(max(CANDIDATES, count))
            held = self._spare or {name: value[:0] for name, value in fresh.items()}
            self._spare = {name: np.concatenate([held[name], fresh[name]]) for name in fresh}
        for name, value in self._spare.items():
            getattr(self, name)[where] = value[:count]
        self._spare = {name: value[count:] for name, value in self._spare.items()}
        self.goal_age[where] = self.steps[where] = 0

    def _command(self, action: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return the command [m/s^2, rad/s], and its squared effort and its turn as fractions."""
        constants = self.task.constants
        command = np.clip(action, -1.0, 1.0).astype(np.float32)
        length = np.sqrt(np.einsum("ni,ni->n", command[:, :3], command[:, :3]))
        command[:, :3] /= np.maximum(1.0, length)[:, None]
        square = np.minimum(1.0, length) ** 2
        turn = command[:, 3].copy()
        command[:, :3] *= constants["max_acceleration"]
        command[:, 3] *= constants["max_turn_rate"]
        return command, square, turn

    def _reward(
        self,
        toward: np.ndarray,
        effort: np.ndarray,
        turn: np.ndarray,
        valid: np.ndarray,
    ) -> np.ndarray:
        constants = self.task.constants
        weights = constants["reward"]
        error = self.velocity.copy()
        error[:, :2] -= constants["desired_speed"] * toward
        error_square = np.einsum("ni,ni->n", error, error) / (2 * constants["max_speed"]) ** 2
        heading = np.cos(self.yaw) * toward[:, 0] + np.sin(self.yaw) * toward[:, 1]
        return (
            -weights["direction"] * error_square
            - weights["orientation"] * (1.0 - heading)
            - weights["turn"] * turn**2
            - weights["acceleration"] * effort
            + np.where(valid, weights["alive"], -weights["failure"])
        )

    def _goal(self) -> np.ndarray:
        return self.goals[np.arange(self.count), self.goal_index]

    def _toward_goal(self) -> tuple[np.ndarray, np.ndarray]:
        offset = self._goal() - self.position[:, :2]
        distance = np.sqrt(np.einsum("ni,ni->n", offset, offset))
        return offset / np.maximum(distance, 1e-6)[:, None], distance

    def _next_goals(self, reached: np.ndarray) -> None:
        self.goal_age += 1
        lasts = self.goal_steps[np.arange(self.count), self.goal_index]
        replaced = reached | (self.goal_age >= lasts)
        self.goal_index = np.minimum(self.goal_index + replaced, GOALS - 1)
        self.goal_age[replaced] = 0

    def _heights(self, maps: np.ndarray, position: np.ndarray, yaw: np.ndarray) -> np.ndarray:
        """Return the heights under the points around each root, relative to it."""
        cosine, sine = np.cos(yaw)[:, None], np.sin(yaw)[:, None]
        x = position[:, 0, None] + cosine * self.ahead - sine * self.left
        y = position[:, 1, None] + sine * self.ahead + cosine * self.left
        return self._ground(maps[:, None], x, y) - position[:, 2, None]

    def _ground(self, maps: np.ndarray, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        _, rows, columns = self.task.heights.shape
        scale = np.float32(1.0 / self.task.constants["resolution"])
        column = np.floor((x - self.task.origin[maps, 0]) * scale + np.float32(0.5))
        row = np.floor((y - self.task.origin[maps, 1]) * scale + np.float32(0.5))
        column = np.clip(column, 0, columns - 1).astype(np.int32)
        row = np.clip(row, 0, rows - 1).astype(np.int32)
        return self.task.heights.reshape(-1).take((maps * rows + row) * columns + column)

    def _valid(self, heights: np.ndarray) -> np.ndarray:
        near = heights[:, self.reach]
        reached = np.any((near >= self.reach_low) & (near <= self.reach_high), axis=1)
        return reached & np.all(heights[:, self.trunk] <= self.trunk_bottom, axis=1)

    def _observation(self, heights: np.ndarray) -> np.ndarray:
        constants = self.task.constants
        toward, _ = self._toward_goal()
        cosine, sine = np.cos(self.yaw), np.sin(self.yaw)
        observation = np.empty((self.count, self.size), np.float32)
        observation[:, 0] = cosine * self.velocity[:, 0] + sine * self.velocity[:, 1]
        observation[:, 1] = cosine * self.velocity[:, 1] - sine * self.velocity[:, 0]
        observation[:, 2] = self.velocity[:, 2]
        observation[:, 3] = wrapped(np.arctan2(toward[:, 1], toward[:, 0]) - self.yaw)
        low, high = constants["height_low"], constants["height_high"]
        np.clip(heights[:, : self.seen], low, high, out=observation[:, 4:])
        return observation

    def _draw(self, count: int) -> dict[str, np.ndarray]:
        """Draw starts and goals; return the valid ones."""
        task, random = self.task, self.random
        link = np.minimum(np.searchsorted(task.share, random.random(count)), len(task.share) - 1)
        maps = task.map_index[link].astype(np.int32)
        near = random.random(count) < task.constants["near_share"]
        area = np.where(near[:, None], task.near_area[link], task.start_area[link])
        place = self._uniform(area)
        yaw = random.uniform(-np.pi, np.pi, count).astype(np.float32)
        speed = task.constants["desired_speed"] * np.maximum(random.uniform(-1, 1, count), 0.0)
        velocity = np.stack([speed * np.cos(yaw), speed * np.sin(yaw), 0 * speed], axis=-1)
        position = self._standing(maps, place)
        position[:, 2] += random.uniform(*HEIGHT_SPREAD, count)
        goals = np.stack(
            [self._uniform(task.goal_area[link])]
            + [self._uniform(task.arena_area[link]) for _ in range(GOALS - 1)],
            axis=1,
        )
        low, high = task.constants["goal_steps"]
        steps = random.integers(low, high + 1, (count, GOALS))
        steps[:, 0] = 2**30
        arrival = self._standing(maps, goals[:, 0])
        towards = np.arctan2(*(goals[:, 0] - place).T[::-1]).astype(np.float32)
        valid = self._valid(self._heights(maps, position, yaw))
        valid &= self._valid(self._heights(maps, arrival, towards))
        drawn: dict[str, Any] = {"position": position, "velocity": velocity, "yaw": yaw}
        drawn |= {"map": maps, "goals": goals, "goal_steps": steps}
        wanders = random.random(count) < task.constants["wander_share"]
        drawn["goal_index"] = wanders.astype(np.int32)
        return {name: value[valid] for name, value in drawn.items()}

    def _standing(self, maps: np.ndarray, place: np.ndarray) -> np.ndarray:
        ground = self._ground(maps, place[:, 0], place[:, 1])
        ground = np.where(ground < NO_GROUND, 0.0, ground)
        height = ground + self.task.constants["walking_height"]
        return np.concatenate([place, height[:, None]], axis=1).astype(np.float32)

    def _uniform(self, area: np.ndarray) -> np.ndarray:
        low, high = area[:, 0::2], area[:, 1::2]
        return (low + (high - low) * self.random.random(low.shape)).astype(np.float32)


def wrapped(angle: np.ndarray) -> np.ndarray:
    """Return an angle within [-pi, pi)."""
    return ((angle + np.pi) % (2 * np.pi) - np.pi).astype(np.float32)
