"""Robots that policies steer, loaded and put on the page; JAX is imported only here."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from jaxleas.configuration import Allow
from jaxleas.runs import interrupts_deferred

if TYPE_CHECKING:
    from viser import ViserServer

    from jaxleas.envs.steering import SteeringEnv
    from jaxleas.guide import OnnxPolicy
    from jaxleas.terrain import HeightMap
    from jaxleas.training import Policy
    from jaxleas.viewer.drive import Drive

    NamedRobot = tuple[str, SteeringEnv, Policy | OnnxPolicy]


def load_robots(policies: Sequence[Path], allow: Allow) -> "list[NamedRobot]":
    """Return name, environment and policy of each robot."""
    with interrupts_deferred():
        from jaxleas.envs.steering import SteeringEnv
        from jaxleas.guide import load_policy
        from jaxleas.xla import keep_compiled_programs

    keep_compiled_programs()
    loaded = [load_policy(each, allow) for each in policies]
    envs = [SteeringEnv(each.config, allow=allow) for each in loaded]
    return list(zip(names_of(policies), envs, loaded, strict=True))


def drive_policies(
    server: "ViserServer",
    terrain: "HeightMap",
    robots: "list[NamedRobot]",
    start: tuple[float, float, float] | None,
    goal: tuple[float, float] | None,
) -> "Drive":
    """Return robots that stand at a start on the page, sent to a goal if one is given."""
    with interrupts_deferred():
        from jaxleas.guide import choose_start, require_start
        from jaxleas.terrain import make_atlas
        from jaxleas.viewer.drive import Drive
        from jaxleas.viewer.driven_robot import DrivenRobot
        from jaxleas.viewer.ground import look_near

    first = robots[0][1]
    place = choose_start(first, terrain) if start is None else require_start(first, terrain, start)
    x, y, _ = place.position
    look_near(server, terrain, (float(x), float(y)))
    atlas = make_atlas([terrain])
    driven = [DrivenRobot(name, env, policy, atlas) for name, env, policy in robots]
    drive = Drive(server, terrain, driven, place)
    if goal is not None:
        drive.send(goal)
    return drive


def names_of(paths: Sequence[Path]) -> list[str]:
    """Return the names of policies: the run folder, with the file where two are equal."""
    whole = [each.resolve() for each in paths]
    short = [each.parent.name if each.stem == "policy" else each.stem for each in whole]
    return [
        name if short.count(name) == 1 else "/".join(each.parts[-2:])
        for name, each in zip(short, whole, strict=True)
    ]
