"""The function behind `jaxleas robot make`."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from jaxleas.types import InputError


@dataclass(frozen=True)
class Choices:
    """Choices that are often stated; a file of --options may state all.

    Attributes:
        name: name of the robot; by default that of --out.
        root: link of the root; by default that which nothing carries.
        kind: kind of the feet, foot or point_foot; by default as their shapes are.
        sole: middle of a sole in the frame of the first foot's link [m].
        half_size: half length and half width of a sole [m].
        friction: friction coefficient between feet and ground.
        root_height: height of the root in the reference stance [m].
        walking_height: height of the root along guide paths [m].
        samples: number of configurations of each leg that are drawn.
        seed: seed of what is drawn.
        packages: folders of packages whose meshes the URDF names.
    """

    name: str | None = None
    root: str | None = None
    kind: str | None = None
    sole: tuple[float, float, float] | None = None
    half_size: tuple[float, float] | None = None
    friction: float | None = None
    root_height: float | None = None
    walking_height: float | None = None
    samples: int | None = None
    seed: int | None = None
    packages: Sequence[str] | None = None


def make(
    urdf: Path,
    *,
    out: Path,
    feet: Sequence[str] = (),
    hands: Sequence[str] = (),
    options: Path | None = None,
    picture: Path | None = None,
    compare: bool = True,
    choices: Choices = Choices(),
) -> None:
    """Make a robot's file from its URDF: shapes, ranges of motion, steps, masses, a stance.

    Args:
        urdf: URDF file.
        out: file of the robot, .json; in the folder robots/ of the working folder its name is
            enough for other commands.
        feet: links of the feet, or frames at their soles.
        hands: links of the palms.
        options: YAML file of choices (docs/your_own.md#robot lists all).
        picture: file of the picture (.png, .svg, .pdf); by default that of --out with .png.
        compare: whether to compare with Pinocchio, where it is installed.
        choices: what the URDF does not state.

    Raises:
        InputError: the URDF or a choice is no good; nothing is written.
    """
    from importlib.metadata import version

    from jaxleas.configuration import load_layers
    from jaxleas.files import digest_of
    from jaxleas.modelling.checks import remarks, require_sound
    from jaxleas.modelling.making import draws_of, make_robot
    from jaxleas.modelling.options import MakeOptions
    from jaxleas.modelling.picture import draw_robot
    from jaxleas.modelling.sketch import sketch_robot
    from jaxleas.modelling.twin import compare_with_pinocchio
    from jaxleas.robots import robot_names, write_robot
    from jaxleas.runs import Progress
    from jaxleas.terrain import require_picture

    if out.suffix != ".json":
        raise InputError(f"--out {out}: a robot's file ends with .json")
    drawn = out.with_suffix(".png") if picture is None else picture
    require_picture(drawn)
    given = {"feet": list(feet), "hands": list(hands), **asdict(choices)}
    chosen = load_layers(MakeOptions, _layers(options, given))
    name = chosen.name or out.stem
    chosen = load_layers(MakeOptions, [*_layers(options, given), ("--out", {"name": name})])
    digest = digest_of(urdf)
    sketch = sketch_robot(urdf, chosen, print)
    if compare:
        print(compare_with_pinocchio(sketch))
    done = 0
    with Progress(draws_of(sketch, chosen), unit="configurations") as progress:

        def advance(count: int) -> None:
            nonlocal done
            done += count
            progress.update(done)

        robot = make_robot(sketch, name, chosen, advance)
    require_sound(robot, chosen)
    for sentence in remarks(robot, sketch.com):
        print(sentence)
    draw_robot(robot, drawn)
    made = {
        "by": "jaxleas robot make",
        "version": version("jaxleas"),
        "urdf": urdf.name,
        "urdf_sha256": digest,
        "options": chosen.model_dump(mode="json", exclude_none=True),
    }
    about = (
        f"{sketch.tree.title}; metres, kilograms, radians, root frame; a limb's range of motion is"
        " {x : normals x <= offsets}, X_in_Y is X's position in the frame of foot Y"
    )
    write_robot(out, robot, about=about, made=made)
    print(_summary(robot))
    called = out if name in robot_names() or out.parent.name != "robots" else name
    print(
        f"written to {out}, drawn in {drawn}; use it as  --robot {called}  or  --env.robot {called}"
    )


def _layers(options: Path | None, given: dict[str, Any]) -> list[tuple[str, dict[str, Any]]]:
    """Return what the file of options and the command line state, the weakest first."""
    from jaxleas.configuration import layers_of

    stated = {key: value for key, value in given.items() if value not in (None, [], ())}
    return [*([] if options is None else layers_of(options)), ("the command line", stated)]


def _summary(robot: Any) -> str:
    """Return the numbers of a robot that a user would check first."""
    lines = [
        f"{robot.name}: {robot.mass:g} kg, root {robot.root_height:g} m high, walking at"
        f" {robot.walking_height:g} m"
    ]
    for box in robot.trunk:
        lines.append(f"  trunk from {list(box.low)} to {list(box.high)} m")
    for limb, effector in zip(robot.limbs, robot.effectors, strict=True):
        low, high = limb.range_of_motion.bounds.low, limb.range_of_motion.bounds.high
        size = "" if effector.kind == "point_foot" else f" of +-{effector.half_size} m"
        lines.append(
            f"  {effector.name}, a {effector.kind.replace('_', ' ')}{size}: from"
            f" ({low[0]:.3f}, {low[1]:.3f}, {low[2]:.3f}) to"
            f" ({high[0]:.3f}, {high[1]:.3f}, {high[2]:.3f}) m,"
            f" {len(limb.range_of_motion.offsets)} faces"
        )
    return "\n".join(lines)
