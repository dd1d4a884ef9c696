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
    folder = resources.files("jaxleas.footsteps") / "data"
    name = f"{controller.name}_{controller.robot}.npz"
    with resources.as_file(folder / name) as path:
        if not path.exists():
            raise InputError(
                f"the package has no motion models of controller {controller.name} on"
                f" {controller.robot}: make some with jaxleas gait collect and jaxleas gait fit,"
                " and give them as --models"
            )
        model = read_motion_model(path)
    controller.require_same(model.controller, f"the package's {name}", "the walk")
    return model
