"""The one place where walking controllers are named."""

from collections.abc import Callable, Collection
from typing import Annotated, Any

from jaxleas.configuration import Registry
from jaxleas.controllers.controller import Controller
from jaxleas.controllers.trot import Trot
from jaxleas.controllers.trot_settings import TrotGains, TrotSettings
from jaxleas.physics import Body
from jaxleas.types import InputError


def _require_controller(name: str, item: Any) -> None:
    if not callable(item):
        raise InputError(
            f"{name} is not a controller: give a class or function that makes one of a robot's"
            " jaxleas.physics.Body"
        )


CONTROLLERS: Registry[Callable[[Body], Controller]] = Registry(
    "controller",
    {
        "trot": "jaxleas.controllers.catalogue:trot",
        "trot_high": "jaxleas.controllers.catalogue:trot_high",
        "trot_quick": "jaxleas.controllers.catalogue:trot_quick",
    },
    _require_controller,
)
DEFAULT_CONTROLLER = "trot"
ControllerName = Annotated[str, CONTROLLERS]
"""Type of a command's option: its help lists the controllers."""


def find_controller(name: str, body: Body, allow: Collection[str] = ()) -> Controller:
    """Return a controller of a robot.

    Args:
        name: name of a controller, path of a policy (.onnx) with its description (.json) beside
            it, or MODULE:CLASS of the user's own.
        body: robot.
        allow: each MODULE:CLASS that a person has named on a command line or in a call.

    Raises:
        InputError: there is no such controller, or it is not of this robot.
    """
    if name.endswith(".onnx"):
        from jaxleas.controllers.onnx_controller import OnnxController

        return OnnxController(name, body)
    return CONTROLLERS.find(name, allow)(body)


def trot(body: Body) -> Trot:
    """Return the trot with swings of 6.5 cm, as the thesis's robot has them."""
    return Trot("trot", body)


def trot_high(body: Body) -> Trot:
    """Return the trot with swings of 10 cm."""
    return Trot(
        *("trot_high", body, TrotSettings(swing_height=0.10)),
        TrotGains(swing_stiffness=4000.0, swing_damping=90.0),  # a swing of twice the acceleration
    )


def trot_quick(body: Body) -> Trot:
    """Return a quicker trot, whose feet touch down by the capture point."""
    return Trot("trot_quick", body, TrotSettings(cycle=0.50, touchdown="capture"))
