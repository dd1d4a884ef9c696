"""Which quadruped walks on the page."""

from dataclasses import dataclass
from pathlib import Path

from jaxleas.types import InputError


@dataclass(frozen=True)
class WalkerOptions:
    """The options of `jaxleas view` that make a quadruped.

    Attributes:
        controller: name of the controller that walks.
        start: x, y [m] and heading [deg]; None for the origin or, if there is no room, the middle.
        robot: name of the robot, or path of its MJCF file; None for the usual one.
        models: file of motion models of the controller; None for those of the package.
        proposal: file of a proposal that is asked before the planner, or 'shipped'; None for none.
    """

    controller: str
    start: tuple[float, float, float] | None = None
    robot: str | None = None
    models: Path | None = None
    proposal: str | None = None


def require_walker(controller: str | None, models: Path | None, proposal: str | None) -> None:
    """Refuse options of a quadruped where none walks.

    Raises:
        InputError: motion models or a proposal are given without a controller.
    """
    for option, given in (("--models", models), ("--proposal", proposal)):
        if given is not None and controller is None:
            raise InputError(f"{option} needs --controller: it serves a quadruped's planner")
