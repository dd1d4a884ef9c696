"""Motion models that come with the package, by controller."""

from importlib import resources

from jaxleas.footsteps.model import MotionModel
from jaxleas.footsteps.model_file import read_motion_model
from jaxleas.types import ControllerIdentity, InputError


def shipped_model(controller: ControllerIdentity) -> MotionModel:
    """Return the package's motion models of a controller (docs/quadruped.md says of what data).

    Raises:
        InputError: no models are shipped for it, or they are of another identity.
    """
    model = shipped_model_of(controller.name, controller.robot)
    where = f"the package's {controller.name}_{controller.robot}.npz"
    controller.require_same(model.controller, where, "the walk")
    return model


def shipped_model_of(controller: str, robot: str) -> MotionModel:
    """Return the package's motion models by the names of a controller and a robot.

    Raises:
        InputError: no models are shipped for them.
    """
    folder = resources.files("jaxleas.footsteps") / "data"
    name = f"{controller}_{robot}.npz"
    if name not in (each.name for each in folder.iterdir()):
        raise InputError(
            f"the package has no motion models of controller {controller} on {robot}: make some"
            " with jaxleas gait collect and jaxleas gait fit, and give them as --models"
        )
    with resources.as_file(folder / name) as path:
        return read_motion_model(path)
