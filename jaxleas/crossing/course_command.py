"""The function behind `jaxleas gait course`."""

from pathlib import Path

from jaxleas.crossing.course import Course
from jaxleas.crossing.courses import make_course
from jaxleas.guide import write_guide_paths
from jaxleas.terrain import write_scene
from jaxleas.types import InputError


def course(name: str, *, out: Path, path: Path | None = None) -> None:
    """Write a course for quadrupeds as a scene (.json): stairs, gaps, stones, waypoints.

    Args:
        name: name such as stairs_1, gaps_12cm or stones; a wrong name prints all of them.
        out: file of the scene, .json.
        path: file for the way across as a guide path, .npz, for `jaxleas gait walk --waypoints`.
    """
    if out.suffix != ".json":
        raise InputError(f"{out}: the name of a scene must end in .json")
    if path is not None and path.suffix != ".npz":
        raise InputError(f"{path}: the name of a guide path must end in .npz")
    made = make_course(name)
    write_scene(out, made.scene)
    if path is not None:
        write_guide_paths(path, [made.path], ["reached"])
    goal = f"{made.goal.x:g},{made.goal.y:g},{made.goal.yaw:g}"
    print(f"{name}: {len(made.scene.surfaces)} surfaces; walk from 0,0,0 to {goal}{_by(made)}")
    print(f"written to {out}" + ("" if path is None else f" and {path}"))


def _by(made: Course) -> str:
    """Return the corners of the way in words."""
    by = " and ".join(f"{x:g},{y:g}" for x, y in made.corners)
    return f" by {by} (--path writes this way)" if by else ""
