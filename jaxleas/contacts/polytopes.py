"""How far a step and the centre of mass reach: four polytopes in the frame of a foot."""

from dataclasses import dataclass
from functools import cache, cached_property

import numpy as np
from jaxtyping import Float

from jaxleas.files import refuse_misspelt_keys
from jaxleas.geometry.polytopes import Polytope
from jaxleas.robots import load_robot
from jaxleas.types.errors import InputError

NAMES = ("RF_in_LF", "LF_in_RF", "COM_in_LF", "COM_in_RF")


@dataclass(frozen=True, eq=False)
class StepPolytopes:
    """Relative reach; "X_in_Y" is X's position in Y's frame (x forward, y left, z up).

    Attributes:
        foot: by the standing foot: where the other one may be, e.g. `foot["LF"]` is RF_in_LF.
        com: by the foot: where the centre of mass may be; empty for the model "feet".
    """

    foot: dict[str, Polytope]
    com: dict[str, Polytope]

    @cached_property
    def foot_corners(self) -> dict[str, Float[np.ndarray, "V 3"]]:
        """Corners of each foot polytope [m]."""
        return {name: polytope.vertices for name, polytope in self.foot.items()}


def make_polytope(A: np.ndarray, b: np.ndarray) -> Polytope:
    """Return A x <= b with rows scaled to unit length, so that slack is in metres."""
    length = np.linalg.norm(A, axis=1)
    return Polytope(A / length[:, None], b / length)


def read_polytopes(where: str, content: object, model: str) -> StepPolytopes:
    """Return the polytopes of a parsed {"RF_in_LF": {"A", "b"}, ...}.

    Raises:
        InputError: one is missing or malformed; says which.
    """
    needed = NAMES if model == "two_com" else NAMES[:2]
    if not isinstance(content, dict):
        raise InputError(f"{where} must be an object with {', '.join(needed)}, each {{A, b}}")
    missing = [name for name in needed if name not in content]
    if missing:
        raise InputError(f"{where} lacks {', '.join(missing)}, which model '{model}' needs")
    refuse_misspelt_keys(where, content, NAMES)
    made = {name: _polytope(f"{where}: {name}", content[name]) for name in NAMES if name in content}
    return StepPolytopes(
        foot={name[-2:]: each for name, each in made.items() if not name.startswith("COM")},
        com={name[-2:]: each for name, each in made.items() if name.startswith("COM")},
    )


def _polytope(where: str, content: object) -> Polytope:
    if not isinstance(content, dict) or not {"A", "b"} <= content.keys():
        raise InputError(f"{where} must be {{A: [[x, y, z], ...], b: [...]}} with A x <= b")
    try:
        A, b = np.array(content["A"]), np.array(content["b"])
        if not (A.dtype.kind in "iuf" and b.dtype.kind in "iuf"):
            raise ValueError("not numbers")
        A, b = A.astype(np.float64), b.astype(np.float64)
    except (OverflowError, TypeError, ValueError) as error:
        raise InputError(f"{where}: A and b must be lists of numbers") from error
    if A.ndim != 2 or A.shape[1:] != (3,) or b.shape != A.shape[:1]:
        raise InputError(
            f"{where}: A has shape {A.shape} and b {b.shape}; give n rows of 3, and n numbers"
        )
    if not (np.isfinite(A).all() and np.isfinite(b).all()):
        raise InputError(f"{where} holds a number that is not finite")
    if (np.linalg.norm(A, axis=1) < 1e-9).any():
        raise InputError(f"{where}: A has a row of zeros, which bounds nothing")
    polytope = make_polytope(A, b)
    try:
        _ = polytope.vertices
    except InputError as error:
        raise InputError(f"{where} bounds no volume: {error}") from error
    return polytope


@cache
def load_step_polytopes(robot: str) -> StepPolytopes:
    """Return the step polytopes of a robot, which its file holds.

    Raises:
        InputError: there are none for this robot.
    """
    try:
        steps = load_robot(robot).steps
    except InputError as error:
        raise InputError(_no_steps(robot)) from error
    if not steps:
        raise InputError(_no_steps(robot))
    content = {name: {"A": each.normals, "b": each.offsets} for name, each in steps.items()}
    return read_polytopes(f"robot {robot}: steps", content, "two_com")


def _no_steps(robot: str) -> str:
    return f"there are no step polytopes for robot {robot!r}; give the problem its 'polytopes'"
