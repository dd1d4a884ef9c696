"""Reach of a step and of the centre of mass: polytopes in the frame of an effector."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np

from jaxleas.files import refuse_misspelt_keys
from jaxleas.geometry import Polytope
from jaxleas.robots import load_robot
from jaxleas.types import InputError


@dataclass(frozen=True, eq=False)
class StepPolytopes:
    """Relative reach; "X_in_Y" is X's position in Y's frame (x forward, y left, z up).

    Attributes:
        relative: positions of one effector in another one's frame, by names such as "RF_in_LF".
        com: positions of the centre of mass, by effector; empty for the model "feet".
    """

    relative: dict[str, Polytope]
    com: dict[str, Polytope]

    def reach(self, moving: str, standing: str) -> Polytope:
        """Return the polytope of one effector's positions in the frame of another one."""
        return self.relative[relative_name(moving, standing)]


def relative_name(moving: str, standing: str) -> str:
    """Return the name of the polytope of one effector in the frame of another one."""
    return f"{moving}_in_{standing}"


def polytope_names(effectors: Sequence[str], model: str) -> tuple[str, ...]:
    """Return the names of all polytopes that a model of steps needs.

    Args:
        effectors: names of the effectors that step or stand.
        model: "feet" or "two_com".
    """
    pairs = [(one, other) for other in effectors for one in effectors if one != other]
    relative = [relative_name(*pair) for pair in pairs]
    return (*relative, *(f"COM_in_{each}" for each in effectors if model == "two_com"))


def make_polytope(A: np.ndarray, b: np.ndarray) -> Polytope:
    """Return A x <= b with rows scaled to unit length, so that slack is in metres."""
    length = np.linalg.norm(A, axis=1)
    return Polytope(A / length[:, None], b / length)


def read_polytopes(
    where: str, content: object, model: str, effectors: Sequence[str], others: Sequence[str] = ()
) -> StepPolytopes:
    """Return the polytopes of a parsed {"RF_in_LF": {"A", "b"}, ...}.

    Args:
        where: name of the file, for messages.
        content: parsed object.
        model: "feet" or "two_com".
        effectors: names of the effectors that step or stand.
        others: names of further effectors whose polytopes may be present.

    Raises:
        InputError: a polytope is missing or malformed; says which one.
    """
    needed = polytope_names(effectors, model)
    known = polytope_names([*effectors, *others], "two_com")
    if not isinstance(content, dict):
        raise InputError(f"{where} must be an object with {', '.join(needed)}, each {{A, b}}")
    missing = [name for name in needed if name not in content]
    if missing:
        raise InputError(f"{where} lacks {', '.join(missing)}, which model '{model}' needs")
    refuse_misspelt_keys(where, content, known)
    made = {name: _polytope(f"{where}: {name}", content[name]) for name in known if name in content}
    com = {name.removeprefix("COM_in_"): each for name, each in made.items() if _is_com(name)}
    return StepPolytopes({name: each for name, each in made.items() if not _is_com(name)}, com)


def _is_com(name: str) -> bool:
    return name.startswith("COM_in_")


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
def load_step_polytopes(robot: str, effectors: tuple[str, ...] | None = None) -> StepPolytopes:
    """Return the step polytopes in a robot's file.

    Args:
        robot: name of the robot.
        effectors: names of the effectors that step or stand; its feet by default.

    Raises:
        InputError: there are no polytopes for this robot.
    """
    try:
        described = load_robot(robot)
    except InputError as error:
        raise InputError(_no_steps(robot)) from error
    steps = described.steps
    if not steps:
        raise InputError(_no_steps(robot))
    content = {name: {"A": each.normals, "b": each.offsets} for name, each in steps.items()}
    every = [each.name for each in described.effectors]
    used = effectors or described.foot_names
    others = [name for name in every if name not in used]
    model = "two_com" if any(map(_is_com, steps)) else "feet"
    return read_polytopes(f"robot {robot}: steps", content, model, used, others)


def _no_steps(robot: str) -> str:
    return f"there are no step polytopes for robot {robot!r}; give the problem its 'polytopes'"
