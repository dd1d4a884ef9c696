"""Clips to play back: guide paths, and contact plans with the problems they solve."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Bool, Float

from jaxleas.contacts.plan import ContactPlan, read_plan
from jaxleas.contacts.problem import ContactProblem
from jaxleas.contacts.problem_file import read_problem
from jaxleas.guide.files import read_guide_paths
from jaxleas.robots.effector import LIMB_OF_FOOT
from jaxleas.types import GuidePath, InputError, RootPose

SECONDS_A_PHASE = 1.0  # duration of a phase: a contact plan has no times


@dataclass(frozen=True)
class Foothold:
    """A foot on the ground.

    Attributes:
        limb: name of the limb, "left" or "right" of bipeds.
        position: middle of the sole [m].
        yaw: heading [rad].
        time: time at which the foot lands [s].
        until: time at which the same foot leaves [s]; infinity for the last foothold.
    """

    limb: str
    position: Float[np.ndarray, " 3"]
    yaw: float
    time: float
    until: float


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
        half_size: half sizes of a sole [m].
        robot: name of the robot that moves; None where the file does not say.
    """

    name: str
    time: Float[np.ndarray, " T"]
    position: Float[np.ndarray, "T 3"]
    yaw: Float[np.ndarray, " T"]
    valid: Bool[np.ndarray, " T"]
    footholds: tuple[Foothold, ...] = ()
    half_size: tuple[float, float] = (0.1, 0.06)
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


def read_guide_clips(path: Path) -> list[Clip]:
    """Read the guide paths of a file as clips.

    Raises:
        InputError: the file cannot be used.
    """
    file = read_guide_paths(path)
    reasons = file.reasons or [""] * len(file.paths)
    return [
        guide_clip(f"path {index} {reason}".strip(), each)
        for index, (each, reason) in enumerate(zip(file.paths, reasons, strict=True))
    ]


def guide_clip(name: str, path: GuidePath) -> Clip:
    """Return a guide path as a clip."""
    time = np.asarray(path.time, np.float64) - path.time[0]
    if np.any(np.diff(time) <= 0.0):
        raise InputError(f"{name}: its times do not ascend")
    return Clip(name, time, path.position, np.unwrap(path.yaw), path.valid)


def read_plan_clip(plan: Path, problem: Path) -> Clip:
    """Read a contact plan and the problem it solves as a clip, one second per phase.

    Raises:
        InputError: a file cannot be used, or the plan has footholds for other phases.
    """
    asked, answer = read_problem(problem), read_plan(plan)
    made = 0 if answer.footholds is None else len(answer.footholds)
    if made > len(asked):
        raise InputError(
            f"{plan} has footholds for {made} phases, {problem} has {len(asked)}: it answers"
            " another problem"
        )
    return plan_clip(Path(plan).stem, asked, answer)


def plan_clip(name: str, problem: ContactProblem, plan: ContactPlan) -> Clip:
    """Return a contact plan as a clip: phase k lands after k + 1 phases."""
    made = [] if plan.footholds is None else list(plan.footholds)
    landings = [(foot, pose.position, pose.yaw, 0.0) for foot, pose in problem.initial.items()]
    landings += [
        (phase.foot, point, phase.yaw, (index + 1) * SECONDS_A_PHASE)
        for index, (phase, point) in enumerate(zip(problem.phases, made, strict=False))
    ]
    footholds = []
    for index, (foot, point, yaw, time) in enumerate(landings):
        leaves = [later[3] for later in landings[index + 1 :] if later[0] == foot]
        limb = LIMB_OF_FOOT.get(foot, foot)
        footholds.append(Foothold(limb, np.asarray(point), yaw, time, min(leaves, default=np.inf)))
    phases = [phase for phase in problem.phases[: max(len(made), 1)] if phase.root is not None]
    known = len(phases) == max(len(made), 1)
    count = len(made) + 1
    roots = np.array([phase.root for phase in phases]) if known else np.zeros((0, 3))
    yaws = np.unwrap([phase.yaw for phase in phases]) if known else np.zeros(0)
    hold = [0, *range(len(made))] if known else []
    return Clip(
        f"{name} ({plan.status})",
        SECONDS_A_PHASE * np.arange(count, dtype=np.float64),
        roots[hold] if known else roots,
        yaws[hold] if known else yaws,
        np.ones(count, bool),
        tuple(footholds),
        problem.foot_half_size,
        problem.robot,
    )
