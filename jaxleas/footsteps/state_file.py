"""Files of walking states and of footstep plans, `.json`."""

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from jaxleas.files import read_typed, write_json
from jaxleas.footsteps.plan import FootstepPlan
from jaxleas.footsteps.walking_state import WalkingState
from jaxleas.types import ControllerIdentity, InputError

VERSION = 1
Triple = tuple[float, float, float]


@dataclass(frozen=True)
class _StateFile:
    """A walking state as it is written; see `WalkingState`."""

    controller: str
    robot: str
    com: Triple
    yaw: float
    feet: dict[str, Triple]
    next_foot: str
    com_velocity: Triple = (0.0, 0.0, 0.0)
    yaw_rate: float = 0.0
    command: Triple = (0.0, 0.0, 0.0)
    version: int = field(default=VERSION)


def named_in_state(path: str | Path) -> tuple[str, str]:
    """Return the names of controller and robot that a walking state is of.

    Raises:
        InputError: the file cannot be used.
    """
    found = read_typed(_StateFile, path, "walking state", VERSION)
    return found.controller, found.robot


def read_state(path: str | Path, controller: ControllerIdentity) -> WalkingState:
    """Read a walking state.

    Args:
        path: file of the state.
        controller: identity of the controller whose state is needed.

    Raises:
        InputError: the file cannot be used, or is of another controller or robot.
    """
    found = read_typed(_StateFile, path, "walking state", VERSION)
    for key in ("controller", "robot"):
        wanted = controller.name if key == "controller" else controller.robot
        if getattr(found, key) != wanted:
            raise InputError(
                f"{path}: {key} is '{getattr(found, key)}', but the motion models are of"
                f" '{wanted}': fit models of that {key}"
            )
    if set(found.feet) != set(controller.feet):
        raise InputError(
            f"{path}: feet has {', '.join(found.feet)}; {controller.robot} has"
            f" {', '.join(controller.feet)}"
        )
    if found.next_foot not in controller.feet:
        raise InputError(
            f"{path}: next_foot is '{found.next_foot}'; give one of {', '.join(controller.feet)}"
        )
    foot = controller.feet.index(found.next_foot)
    return WalkingState(
        com=np.array(found.com),
        yaw=found.yaw,
        com_velocity=np.array(found.com_velocity),
        yaw_rate=found.yaw_rate,
        feet=np.array([found.feet[name] for name in controller.feet]),
        pair=next(index for index, pair in enumerate(controller.pairs) if foot in pair),
        command=np.array(found.command),
    )


def write_plan(path: str | Path, plan: FootstepPlan, controller: ControllerIdentity) -> None:
    """Write a footstep plan, whole or not at all."""
    found = np.isfinite(plan.cost)
    write_json(
        path,
        {
            "version": VERSION,
            "controller": controller.name,
            "robot": controller.robot,
            "status": plan.status,
            "message": plan.in_words(),
            "command": plan.command.tolist(),
            "cost": plan.cost if found else None,
            "gap": plan.gap if found else None,
            "expansions": plan.expansions,
            "refused": plan.refused,
            "footsteps": [
                {
                    "swinging": [controller.feet[foot] for foot in controller.pairs[each.pair]],
                    "command": each.command.tolist(),
                    "com": each.com.tolist(),
                    "yaw": each.yaw,
                    "feet": dict(zip(controller.feet, each.feet.tolist(), strict=True)),
                }
                for each in plan.footsteps
            ],
        },
    )
