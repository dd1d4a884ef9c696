"""A walker on a grid that sees a map and chooses a direction: a task that steps on the host."""

import numpy as np

from jaxleas.envs.environment import Task
from jaxleas.envs.heads import Categorical
from jaxleas.envs.mirror import Mirror
from jaxleas.envs.part import Part
from jaxleas.envs.signature import Signature
from jaxleas.envs.task_config import TaskConfig
from jaxleas.envs.task_values import Starts, StepResult

SIDE = 4
VIEW = 2 * SIDE - 1  # side of what is seen: the goal relative to the walker
STEPS = np.array([[0, 0], [0, 1], [0, -1], [1, 0], [-1, 0]])
SWAPPED = (0, 2, 1, 3, 4)  # left and right change places


class MazeConfig(TaskConfig):
    swept = ("haste",)
    task: str = "tests.probes.maze:Maze"
    haste: float = 0.1

    def signature(self) -> Signature:
        goal = Part("goal_map", (VIEW, VIEW), mirror=Mirror.of_map(VIEW, VIEW))
        pace = Part("bias", (1,), mirror=Mirror.of_signs([1.0]))
        return Signature((goal, pace), (Categorical("direction", len(STEPS), SWAPPED),))


class Maze(Task):
    Config = MazeConfig
    on_host = True

    def make_world(self, seeds, examined):
        return {"seeds": np.array(seeds)}

    def draw_starts(self, world, key, count, examined=False):
        state = {
            "place": key.integers(SIDE, size=(count, 2)),
            "goal": key.integers(SIDE, size=(count, 2)),
            "step": np.zeros(count, int),
        }
        apart = np.any(state["place"] != state["goal"], axis=1)
        return Starts(state, apart, np.zeros(count, int))

    def advance(self, world, weights, state, action, disturbance):
        place = np.clip(state["place"] + STEPS[action], 0, SIDE - 1)
        before, after = (
            np.abs(each - state["goal"]).sum(axis=1) for each in (state["place"], place)
        )
        reached, step = after == 0, state["step"] + 1
        result = StepResult(
            reward=(before - after) - weights["haste"],
            terminated=np.zeros(len(step), bool),
            truncated=reached | (step >= 15),
            reached=reached,
        )
        return {"place": place, "goal": state["goal"], "step": step}, result

    def look(self, world, state):
        goal_map = np.zeros((len(state["step"]), VIEW, VIEW), np.float32)
        relative = state["goal"] - state["place"] + SIDE - 1
        goal_map[np.arange(len(goal_map)), relative[:, 0], relative[:, 1]] = 1.0
        return {"goal_map": goal_map, "bias": np.ones((len(goal_map), 1), np.float32)}
