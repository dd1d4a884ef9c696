"""MuJoCo, imported when physics is first used: steering and its commands do without."""

from types import ModuleType

from jaxleas.types import JaxleasError


class NoPhysicsError(JaxleasError):
    """MuJoCo is not installed."""


def import_mujoco() -> ModuleType:
    """Return the module `mujoco`.

    Raises:
        NoPhysicsError: it is not installed.
    """
    try:
        import mujoco
    except ImportError as error:
        raise NoPhysicsError(
            "physics needs MuJoCo: install the extra 'physics', pip install 'jaxleas[physics]'"
        ) from error
    return mujoco
