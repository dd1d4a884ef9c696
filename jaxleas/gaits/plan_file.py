"""Files of gait plans, `.json`."""

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from jaxleas.envs.gait_planning import FEET, STANDING, Phases, QuadrupedConfig
from jaxleas.files import read_typed, write_json
from jaxleas.gaits.gait import Ending
from jaxleas.gaits.gait_plan import GaitPlan, Pair, Program
from jaxleas.types import InputError

VERSION = 1
Triple = tuple[float, float, float]


@dataclass(frozen=True)
class PhaseEntry:
    """A support phase as it is written: at its beginning, in metres, radians and seconds."""

    com: Triple
    yaw: float
    velocity: Pair
    feet: dict[str, Triple]
    contacts: tuple[str, ...]


@dataclass(frozen=True)
class _PlanFile:
    planner: str
    ending: Ending
    goal: Pair
    robot: dict[str, Any]
    program: Program
    phases: tuple[PhaseEntry, ...]
    times: tuple[Pair, ...]
    certificate: dict[str, Any] | None = None
    version: int = VERSION


def write_gait_plan(path: str | Path, plan: GaitPlan, certificate: dict[str, Any]) -> None:
    """Write a plan.

    Args:
        path: path of the file.
        plan: plan.
        certificate: what was found when it was certified.
    """
    phases = plan.phases
    entries = [
        PhaseEntry(
            _numbers(phases.com[row]),
            float(phases.yaw[row]),
            _numbers(phases.velocity[row]),
            {name: _numbers(phases.feet[row, foot]) for foot, name in enumerate(FEET)},
            tuple(np.array(FEET)[STANDING[phases.support[row]]].tolist()),
        )
        for row in range(len(phases.yaw))
    ]
    content = _PlanFile(
        plan.planner,
        plan.ending,
        plan.goal,
        plan.robot.model_dump(mode="json"),
        plan.program,
        tuple(entries),
        tuple(_numbers(each) for each in plan.times),
        certificate,
    )
    write_json(path, asdict(content))


def read_gait_plan(path: str | Path) -> GaitPlan:
    """Read a plan.

    Raises:
        InputError: the file cannot be used.
    """
    found = read_typed(_PlanFile, path, "gait plan", VERSION)
    if len(found.phases) != len(found.times) + 1:
        raise InputError(
            f"{path} is no gait plan: {len(found.phases)} phases and {len(found.times)} times; a"
            " plan has one phase more than it has transitions"
        )
    try:
        robot = QuadrupedConfig.model_validate(found.robot)
    except ValueError as error:
        raise InputError(f"{path} is no gait plan: robot: {error}") from error
    return GaitPlan(
        found.planner,
        found.ending,
        found.goal,
        robot,
        found.program,
        _phases_of(path, found.phases),
        np.array(found.times, float).reshape(-1, 2),
    )


def _phases_of(path: str | Path, entries: tuple[PhaseEntry, ...]) -> Phases:
    supports = []
    for number, entry in enumerate(entries):
        stands = np.isin(FEET, entry.contacts)
        known = set(entry.feet) == set(FEET) and set(entry.contacts) <= set(FEET)
        which = np.flatnonzero((stands == STANDING).all(axis=1))
        if not known or not len(which):
            raise InputError(
                f"{path} is no gait plan: phases.{number}: feet must be {', '.join(FEET)}, and all"
                " of them, or all but one, in contact"
            )
        supports.append(which[0])
    return Phases(
        com=np.array([each.com for each in entries], np.float32),
        yaw=np.array([each.yaw for each in entries], np.float32),
        velocity=np.array([each.velocity for each in entries], np.float32),
        feet=np.array([[each.feet[name] for name in FEET] for each in entries], np.float32),
        support=np.array(supports, np.int32),
    )


def _numbers(values: np.ndarray) -> Any:
    return tuple(float(value) for value in values)
