"""The function behind `jaxleas gait course`."""

from pathlib import Path

from jaxleas.crossing.courses import make_course
from jaxleas.terrain import write_scene
from jaxleas.types import InputError


def course(name: str, *, out: Path) -> None:
    """Write a course for quadrupeds as a scene (.json): stairs, gaps, stepping stones.

    Args:
        name: name such as stairs_1, gaps_12cm or stones; a wrong name prints all of them.
        out: file of the scene, .json.
    """
    if out.suffix != ".json":
        raise InputError(f"{out}: the name of a scene must end in .json")
    made = make_course(name)
    write_scene(out, made.scene)
    goals = ", then ".join(f"{goal.x:g},{goal.y:g},{goal.yaw:g}" for goal in made.goals)
    print(f"{name}: {len(made.scene.surfaces)} surfaces; walk from 0,0,0 to {goals}")
    print(f"written to {out}")
