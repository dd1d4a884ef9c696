"""Ask an exact planner about guide paths over one scene or many, in this process."""

from collections.abc import Sequence

from jaxleas.contacts import AskedGuides, PlannerSettings, find_planner, require_settings
from jaxleas.terrain import Scene
from jaxleas.types import GuidePath, Verdict


def judge(
    planner: str,
    scene: Scene,
    guide_paths: Sequence[GuidePath],
    settings: PlannerSettings | None = None,
    first: int = 0,
    *,
    robot: str,
) -> list[Verdict]:
    """Ask an exact planner about guide paths over one scene.

    Args:
        planner: name of a planner, or MODULE:CLASS of your own, which this call imports.
        scene: scene to walk on.
        guide_paths: guide paths to be judged.
        settings: settings of the planner; its defaults if None.
        first: number of the first guide path in its file.
        robot: name of the robot.

    Raises:
        InputError: planner and settings do not fit, or a guide path cannot be used.
    """
    asked = AskedGuides(robot, [scene], guide_paths, [0] * len(guide_paths), first)
    return ask(planner, asked, settings)


def ask(planner: str, asked: AskedGuides, settings: PlannerSettings | None = None) -> list[Verdict]:
    """Ask an exact planner about guide paths of any robot.

    Args:
        planner: name of a planner, or MODULE:CLASS of your own, which this call imports.
        asked: robot, scenes and guide paths.
        settings: settings of the planner; its defaults if None.

    Returns:
        Verdicts in the order of the guide paths.
    """
    found = find_planner(planner, [planner])
    return found.judge(asked, require_settings(found, settings, asked.robot))
