"""The sampling-based contact planner (T 4.1; Tonneau et al. 2018), for many guide paths at once.

It follows a guide path exactly: from each kept configuration to the next, contacts are kept, or one
is broken and made anew, or, where that fails, one is repositioned at the configuration before.
Guide paths are followed together, each at its own pace, so that NumPy works on all at once.
"""

from collections.abc import Sequence

import numpy as np

from jaxleas.contacts.sampling.case import make_case
from jaxleas.contacts.sampling.follower import GuideFollower
from jaxleas.contacts.sampling.guides import require_usable
from jaxleas.contacts.sampling.plan import SamplingPlan
from jaxleas.contacts.sampling.settings import SamplingSettings
from jaxleas.robots import Robot
from jaxleas.terrain import Scene
from jaxleas.types import GuidePath

_ABREAST = 64  # guide paths followed together: more does not fit the cache


def plan_contacts(
    scene: Scene,
    guide_path: GuidePath,
    settings: SamplingSettings | None = None,
    *,
    robot: Robot,
) -> SamplingPlan:
    """Plan a robot's contacts along one guide path.

    Args:
        scene: surfaces to stand on and obstacles to avoid.
        guide_path: guide path to follow exactly.
        settings: settings of the planner; the published ones by default.
        robot: robot with two legs or more.

    Raises:
        InputError: the guide path or the scene cannot be used.
    """
    return plan_many(scene, [guide_path], settings, robot=robot)[0]


def plan_many(
    scene: Scene,
    guide_paths: Sequence[GuidePath],
    settings: SamplingSettings | None = None,
    *,
    robot: Robot,
) -> list[SamplingPlan]:
    """Plan a robot's contacts along several guide paths over one scene, in one process.

    Every plan is the one that `plan_contacts` makes.
    """
    return plan_over([scene], guide_paths, [0] * len(guide_paths), settings, robot=robot)


def plan_over(
    scenes: Sequence[Scene],
    guide_paths: Sequence[GuidePath],
    scene_index: Sequence[int],
    settings: SamplingSettings | None = None,
    *,
    robot: Robot,
) -> list[SamplingPlan]:
    """Plan a robot's contacts along guide paths, each over one of several scenes, in one process.

    Every plan is the one that `plan_contacts` makes; paths over different scenes are also followed
    together.

    Args:
        scenes: surfaces to stand on and obstacles to avoid, for each scene.
        guide_paths: guide paths to follow exactly.
        scene_index: index of each guide path's scene.
        settings: settings of the planner; the published ones by default.
        robot: robot with two legs or more.

    Returns:
        Plans in the order of the guide paths.

    Raises:
        InputError: a guide path or a scene cannot be used.
    """
    chosen = settings or SamplingSettings()
    for number, path in enumerate(guide_paths):
        require_usable(path, number)
    index = np.asarray(scene_index, dtype=np.int64)
    order = np.argsort(index, kind="stable")
    plans: dict[int, SamplingPlan] = {}
    for first in range(0, len(order), _ABREAST):
        some = order[first : first + _ABREAST]
        used, local = np.unique(index[some], return_inverse=True)
        case = make_case(robot, [scenes[each] for each in used.tolist()], chosen)
        follower = GuideFollower(
            case, [guide_paths[each] for each in some.tolist()], local.tolist()
        )
        plans.update(zip(some.tolist(), follower.plans(), strict=True))
    return [plans[number] for number in range(len(guide_paths))]
