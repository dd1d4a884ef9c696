"""Files of a planner's choices in a lesson: plain arrays and one JSON text."""

import json
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float, Int

from jaxleas.files import parse_json, read_npz, require_version, typed, write_npz
from jaxleas.footsteps import Goal, Node
from jaxleas.types import InputError

VERSION = 1
MAX_BYTES = 2**26
Choice = tuple[Node, Goal, Float[np.ndarray, "3"]]
"""A state, a goal, and the command that a planner chose."""


@dataclass(frozen=True, eq=False)
class LessonRows:
    """States that robots met in a lesson, and what the planner chose there.

    Attributes:
        com: x and y of the centre of mass [m].
        yaw: heading [rad].
        velocity: velocity [m/s] and turning rate [rad/s], in the robot's frame.
        feet: positions of the feet [m].
        pair: index of the pair that swings next.
        command: command until now.
        earlier: command before that one.
        goal: x, y, yaw, distance, angle and speed of the goal, as in `Goal`.
        chosen: command that the planner chose.
    """

    com: Float[np.ndarray, "N 2"]
    yaw: Float[np.ndarray, " N"]
    velocity: Float[np.ndarray, "N 4"]
    feet: Float[np.ndarray, "N E 3"]
    pair: Int[np.ndarray, " N"]
    command: Float[np.ndarray, "N 3"]
    earlier: Float[np.ndarray, "N 3"]
    goal: Float[np.ndarray, "N 6"]
    chosen: Float[np.ndarray, "N 3"]

    def __len__(self) -> int:
        return len(self.yaw)

    def node(self, row: int) -> Node:
        """Return a state."""
        return Node(
            *(self.com[row], float(self.yaw[row]), self.velocity[row], self.feet[row]),
            *(int(self.pair[row]), self.command[row], self.earlier[row]),
        )

    def goal_of(self, row: int) -> Goal:
        """Return the goal that was walked to."""
        return Goal(*map(float, self.goal[row]))

    @classmethod
    def of(cls, chosen: list[Choice], feet: int) -> "LessonRows":
        """Return choices as rows.

        Args:
            chosen: states, goals and commands.
            feet: number of feet of the robot.
        """
        shapes = {"com": (2,), "velocity": (4,), "feet": (feet, 3), "goal": (6,)}
        shapes |= dict.fromkeys(("command", "earlier", "chosen"), (3,))

        def stacked(name: str, values: list[Any]) -> np.ndarray:
            return np.array(values, dtype=float).reshape(len(chosen), *shapes.get(name, ()))

        of_nodes = {
            name: stacked(name, [getattr(node, name) for node, _, _ in chosen])
            for name in ("com", "yaw", "velocity", "feet", "command", "earlier")
        }
        goals = [[getattr(goal, each.name) for each in fields(Goal)] for _, goal, _ in chosen]
        return cls(
            **of_nodes,
            pair=np.array([node.pair for node, _, _ in chosen], dtype=np.int64),
            goal=stacked("goal", goals),
            chosen=stacked("chosen", [command for _, _, command in chosen]),
        )


@dataclass(frozen=True)
class LessonNotes:
    """How a lesson went, and of what it is.

    Attributes:
        key: digest of everything that the lesson depends on.
        course: name of the course.
        outcomes: how each robot's walk ended.
        asked: number of plans that the proposal was asked for; 0 where the planner walked.
        searched: number of those that the planner searched for.
        version: version of the file.
    """

    key: str
    course: str
    outcomes: tuple[str, ...]
    asked: int
    searched: int
    version: int = VERSION


def write_lesson(path: Path, rows: LessonRows, notes: LessonNotes) -> None:
    """Write a lesson to a file, whole or not at all."""
    write_npz(path, metadata=np.array(json.dumps(asdict(notes))), **vars(rows))


def read_lesson(path: Path, key: str) -> tuple[LessonRows, LessonNotes]:
    """Read a lesson.

    Args:
        path: its file.
        key: digest of everything that it must have depended on.

    Raises:
        InputError: the file is damaged, or is that of another distillation.
    """
    names = tuple(each.name for each in fields(LessonRows))
    arrays = read_npz(path, ("metadata", *names), MAX_BYTES)
    content = parse_json(str(arrays["metadata"]), f"{path}: metadata")
    if isinstance(content, dict):
        require_version(content, VERSION, path)
    notes = typed(LessonNotes, content, f"{path}: metadata of no lesson")
    if notes.key != key:
        raise InputError(
            f"{path} is a lesson of other settings, motion models or proposal: give another --out"
        )
    rows = {name: arrays[name] for name in names}
    if len({len(each) for each in rows.values()}) != 1:
        raise InputError(f"{path}: its arrays have different lengths")
    return LessonRows(**rows), notes
