"""Clips to play back: guide paths, and contact plans with the problems they solve."""

import logging
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from jaxtyping import Bool, Float

from jaxleas.contacts import ContactPlan, ContactProblem, read_plan, read_problem
from jaxleas.guide import read_guide_paths
from jaxleas.robots import Robot, height_complaint, robot_for
from jaxleas.terrain import HeightMap
from jaxleas.types import GuidePath, InputError, RootPose, is_ground
from jaxleas.viewer.footholds import Foothold, footholds_of

_LOG = logging.getLogger("jaxleas")
SECONDS_PER_STEP = 1.0  # duration of a step: a contact plan has no times


@dataclass(frozen=True)
class Clip:
    """A motion with times.

    Attributes:
        name: name on the page.
        time: times of the configurations, ascending from 0 [s].
        position: positions of the root [m]; no rows where the root is not known.
        yaw: headings [rad], unwrapped.
        valid: whether each configuration is valid.
        footholds: footholds in order of time; empty for a guide path.
        robot: name of the robot that moves; None where the file does not say.
    """

    name: str
    time: Float[np.ndarray, " T"]
    position: Float[np.ndarray, "T 3"]
    yaw: Float[np.ndarray, " T"]
    valid: Bool[np.ndarray, " T"]
    footholds: tuple[Foothold, ...] = ()
    robot: str | None = None

    @property
    def duration(self) -> float:
        """Time of the last configuration [s]."""
        return float(self.time[-1])

    def at(self, time: float) -> tuple[RootPose, bool] | None:
        """Return the root's pose at a time [s] and whether it is valid; None if it is not known."""
        if not len(self.position):
            return None
        position = np.array([np.interp(time, self.time, each) for each in self.position.T])
        index = int(np.searchsorted(self.time, time + 1e-9, side="right")) - 1
        yaw = float(np.interp(time, self.time, self.yaw))
        return RootPose.from_yaw(position, yaw), bool(self.valid[index])


def read_guide_clips(path: Path, named: str | None = None) -> list[Clip]:
    """Read the guide paths of a file as clips.

    Args:
        path: file of the guide paths.
        named: name of the robot to draw, or path of its file, as a person gave it.

    Raises:
        InputError: the file cannot be used, or its paths are another robot's than the named one's.
    """
    file = read_guide_paths(path)
    robot = None if file.robot is None else robot_for(file.robot, named, path).name
    reasons = file.reasons or [""] * len(file.paths)
    return [
        replace(guide_clip(f"path {index} {reason}".strip(), each), robot=robot)
        for index, (each, reason) in enumerate(zip(file.paths, reasons, strict=True))
    ]


def guide_clip(name: str, path: GuidePath) -> Clip:
    """Return a guide path as a clip."""
    time = np.asarray(path.time, np.float64) - path.time[0]
    if np.any(np.diff(time) <= 0.0):
        raise InputError(f"{name}: its times do not ascend")
    return Clip(name, time, path.position, np.unwrap(path.yaw), path.valid)


def warn_of_height(clips: Sequence[Clip], drawn: Robot, ground: HeightMap) -> None:
    """Warn of paths of nobody known that the drawn robot cannot have walked.

    Args:
        clips: clips to be shown together.
        drawn: robot that is drawn for want of another.
        ground: terrain that the paths cross.
    """
    roots = [each.position for each in clips if each.robot is None and len(each.position)]
    for position in roots:
        below = ground.height_at(position[:, :2].astype(np.float64))
        known = is_ground(below)
        if problem := height_complaint(drawn, position[known, 2] - below[known]):
            _LOG.warning("%s is drawn, but %s", drawn.name, problem)
            return


def read_plan_clip(plan: Path, problem: Path) -> Clip:
    """Read a contact plan and the problem it solves as a clip, one second per step.

    Raises:
        InputError: a file cannot be used, or the plan has footholds for other steps.
    """
    asked, answer = read_problem(problem), read_plan(plan)
    made = 0 if answer.footholds is None else len(answer.footholds)
    if made > len(asked):
        raise InputError(
            f"{plan} has footholds for {made} steps, {problem} has {len(asked)}: it answers"
            " another problem"
        )
    return plan_clip(Path(plan).stem, asked, answer)


def plan_clip(name: str, problem: ContactProblem, plan: ContactPlan) -> Clip:
    """Return a contact plan as a clip: step k lands after k + 1 steps."""
    made = 0 if plan.footholds is None else len(plan.footholds)
    steps = [step for step in problem.steps[: max(made, 1)] if step.root is not None]
    known = len(steps) == max(made, 1)
    count = made + 1
    roots = np.array([step.root for step in steps]) if known else np.zeros((0, 3))
    yaws = np.unwrap([step.yaw for step in steps]) if known else np.zeros(0)
    hold = [0, *range(made)] if known else []
    return Clip(
        f"{name} ({plan.status})",
        SECONDS_PER_STEP * np.arange(count, dtype=np.float64),
        roots[hold] if known else roots,
        yaws[hold] if known else yaws,
        np.ones(count, bool),
        footholds_of(problem, plan, SECONDS_PER_STEP),
        problem.robot,
    )
