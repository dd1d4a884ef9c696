"""The sampling-based contact planner (T 4.1; Tonneau et al. 2018), for many guide paths at once.

It follows a guide path exactly: from each kept configuration to the next, contacts are kept, or one
is broken and made anew, or, where that fails, one is repositioned at the configuration before.
Guide paths are walked together, each at its own pace, so that NumPy works on all of them at once.
"""

from collections.abc import Sequence
from time import perf_counter

import numpy as np

from jaxleas.contacts.sampling.create import Created, create_contacts, put
from jaxleas.contacts.sampling.diary import Diary
from jaxleas.contacts.sampling.first_stance import first_stances
from jaxleas.contacts.sampling.guides import KeptGuides, keep_configurations, require_usable
from jaxleas.contacts.sampling.limbs import SIDES
from jaxleas.contacts.sampling.maintain import maintain_contacts
from jaxleas.contacts.sampling.plan import Ending, SamplingPlan
from jaxleas.contacts.sampling.settings import SamplingSettings
from jaxleas.contacts.sampling.world import World, make_world
from jaxleas.robots import Robot, load_robot
from jaxleas.terrain.scene import Scene
from jaxleas.types import GuidePath

_LOOK = 3  # configurations at which contacts are judged together; most last that long
_ABREAST = 64  # guide paths walked together: more does not fit the cache


def plan_contacts(
    scene: Scene,
    guide_path: GuidePath,
    settings: SamplingSettings | None = None,
    robot: Robot | None = None,
) -> SamplingPlan:
    """Plan a robot's contacts along one guide path.

    Args:
        scene: surfaces to stand on and obstacles to avoid.
        guide_path: guide path to follow exactly.
        settings: settings of the planner; the published ones by default.
        robot: robot with two legs; Talos by default.

    Raises:
        InputError: the guide path or the scene cannot be used.
    """
    return plan_many(scene, [guide_path], settings, robot)[0]


def plan_many(
    scene: Scene,
    guide_paths: Sequence[GuidePath],
    settings: SamplingSettings | None = None,
    robot: Robot | None = None,
) -> list[SamplingPlan]:
    """Plan a robot's contacts along several guide paths over one scene, in one process.

    Every plan is the one that `plan_contacts` makes.
    """
    return plan_over([scene], guide_paths, [0] * len(guide_paths), settings, robot)


def plan_over(
    scenes: Sequence[Scene],
    guide_paths: Sequence[GuidePath],
    scene_index: Sequence[int],
    settings: SamplingSettings | None = None,
    robot: Robot | None = None,
) -> list[SamplingPlan]:
    """Plan a robot's contacts along guide paths, each over one of several scenes, in one process.

    Every plan is the one that `plan_contacts` makes; paths over different scenes are also walked
    together.

    Args:
        scenes: surfaces to stand on and obstacles to avoid, for each scene.
        guide_paths: guide paths to follow exactly.
        scene_index: index of each guide path's scene.
        settings: settings of the planner; the published ones by default.
        robot: robot with two legs; Talos by default.

    Returns:
        Plans in the order of the guide paths.

    Raises:
        InputError: a guide path or a scene cannot be used.
    """
    chosen, robot = settings or SamplingSettings(), robot or load_robot("talos")
    for number, path in enumerate(guide_paths):
        require_usable(path, number)
    index = np.asarray(scene_index, dtype=np.int64)
    order = np.argsort(index, kind="stable")
    plans: dict[int, SamplingPlan] = {}
    for first in range(0, len(order), _ABREAST):
        some = order[first : first + _ABREAST]
        used, local = np.unique(index[some], return_inverse=True)
        world = make_world(robot, [scenes[each] for each in used.tolist()], chosen)
        walk = _Walk(world, [guide_paths[each] for each in some.tolist()], local.tolist())
        plans.update(zip(some.tolist(), walk.plans(), strict=True))
    return [plans[number] for number in range(len(guide_paths))]


class _Walk:
    """Guide paths that are walked together.

    `at` is the configuration that each path reached, `failures` counts its failures in a row,
    and `ends` says how it ended.
    """

    def __init__(
        self, world: World, guide_paths: Sequence[GuidePath], scene_index: Sequence[int]
    ) -> None:
        self.begun = perf_counter()
        self.world = world
        self.guides: KeptGuides = keep_configurations(world, guide_paths, scene_index)
        count = len(guide_paths)
        self.at = np.zeros(count, dtype=np.int64)
        self.failures = np.zeros(count, dtype=np.int64)
        self.repositions = np.zeros(count, dtype=np.int64)
        self.order = np.full(count, len(SIDES))
        self.live = np.ones(count, dtype=bool)
        self.ends: list[tuple[Ending, str]] = [("reached", "")] * count
        self.diary = Diary()

    def plans(self) -> list[SamplingPlan]:
        """Walk all paths to their ends."""
        self._start()
        while self.live.any():
            blocked, can_stay = self._go_on()
            if len(blocked):
                failed = self._step(blocked, can_stay)
                self._reposition(failed)
        return self.diary.plans(self.world, self.guides, self.ends, self.begun)

    def _start(self) -> None:
        first = first_stances(self.world, self.guides)
        self.stances = first.stances
        free = self.guides.trunk_free[:, 0]
        self._stop(
            np.flatnonzero(~free), "trunk", "the trunk touches the scene at the first configuration"
        )
        self._stop(
            np.flatnonzero(free & ~first.found),
            "no_start",
            "no robust stance with both feet exists at the first configuration",
        )
        good = np.flatnonzero(first.found & free)
        self.diary.write(
            "start", good, self.at[good], -1, self.stances[good], first.com[good]
        )  # fmt: skip
        self._finish(good)

    def _go_on(self) -> tuple[np.ndarray, np.ndarray]:
        """Keep contacts while possible; return the blocked paths, and the legs that can stay."""
        walking = np.flatnonzero(self.live)
        ahead = self.at[walking, None] + 1 + np.arange(_LOOK)
        exists = ahead < self.guides.length[walking, None]
        row, look = np.nonzero(exists)
        guide, at = walking[row], ahead[row, look]
        kept = maintain_contacts(
            self.world, self.guides.roots[self.guides.flat(guide, at)], self.stances[guide]
        )
        good = np.zeros(exists.shape, dtype=bool)
        good[row, look] = kept.both & self.guides.trunk_free[guide, at]
        good = np.logical_and.accumulate(good, axis=1)
        taken = good[row, look]
        self.diary.write(
            "kept", guide[taken], at[taken], -1, self.stances[guide[taken]],
            kept.com[taken],
        )  # fmt: skip
        progress = good.sum(axis=1)
        self.at[walking] += progress
        self.failures[walking[progress > 0]] = 0
        self._finish(walking)
        stuck = (progress < _LOOK) & self.live[walking]
        position = np.zeros(exists.shape, dtype=np.int64)
        position[row, look] = np.arange(len(row))
        where = position[np.flatnonzero(stuck), progress[stuck]]
        blocked, can_stay = walking[stuck], kept.limb[where]
        free = self.guides.trunk_free[blocked, self.at[blocked] + 1]
        self._stop(blocked[~free], "trunk", "the trunk touches the scene at the next configuration")
        return blocked[free], can_stay[free]

    def _step(self, blocked: np.ndarray, can_stay: np.ndarray) -> np.ndarray:
        """Break one contact, the oldest first, and make it anew; return the paths that fail."""
        pending = np.arange(len(blocked))
        for turn in range(self.limbs):
            limb = self._by_age(blocked[pending], turn)
            moves = np.arange(self.limbs) == limb[:, None]
            pending_now = (can_stay[pending] | moves).all(axis=1)
            rows, limb = pending[pending_now], limb[pending_now]
            if len(rows):
                guide = blocked[rows]
                made = self._create(guide, self.at[guide] + 1, limb, 0.0)
                done = self._accept("stepped", guide, limb, made, self.at[guide] + 1)
                self.failures[guide[done]] = 0
                pending = np.setdiff1d(pending, rows[done], assume_unique=True)
        self._finish(blocked)
        return blocked[pending]

    def _reposition(self, failed: np.ndarray) -> None:
        """Move one foot at the last configuration reached, the oldest contact first."""
        self.failures[failed] += 1
        settings = self.world.settings
        enough = self.failures[failed] >= settings.max_tries
        self._stop(
            failed[enough],
            "no_contact",
            "neither foot finds a contact that leads on to the next configuration, nor after "
            "repositioning",
        )
        many = ~enough & (self.repositions[failed] >= settings.max_repositions)
        self._stop(
            failed[many],
            "repositions",
            f"more than {settings.max_repositions} repositions were needed",
        )
        pending = failed[~enough & ~many]
        for turn in range(self.limbs):
            if len(pending):
                limb = self._by_age(pending, turn)
                made = self._create(pending, self.at[pending], limb, settings.moved)
                done = self._accept("repositioned", pending, limb, made, self.at[pending])
                self.repositions[pending[done]] += 1
                pending = pending[~done]
        self._stop(
            pending,
            "no_contact",
            "neither foot finds a contact that leads on to the next configuration, nor can one be "
            "repositioned",
        )

    def _by_age(self, guide: np.ndarray, turn: int) -> np.ndarray:
        """Return the limb with the oldest contact (turn 0), the next one (turn 1), and so on."""
        return np.argsort(self.stances.since[guide], axis=1, kind="stable")[:, turn]

    @property
    def limbs(self) -> int:
        """Number of limbs that move."""
        return self.stances.since.shape[1]

    def _create(
        self, guide: np.ndarray, at: np.ndarray, limb: np.ndarray, least_move: float
    ) -> Created:
        return create_contacts(
            self.world,
            self.guides.aim(guide, at, limb),
            self.stances[guide],
            self.order[guide],
            least_move=least_move,
        )

    def _accept(self, how, guide: np.ndarray, limb: np.ndarray, made: Created, at: np.ndarray):
        """Take the contacts that were found; return for which paths there is one."""
        done = made.found
        rows = guide[done]
        put(self.stances, rows, made.stances[done])
        self.at[rows] = at[done]
        self.order[rows] += 1
        self.diary.write(
            how, rows, self.at[rows], limb[done], self.stances[rows], made.com[done]
        )  # fmt: skip
        return done

    def _finish(self, guide: np.ndarray) -> None:
        self.live[guide[self.at[guide] >= self.guides.length[guide] - 1]] = False

    def _stop(self, guide: np.ndarray, ending: Ending, reason: str) -> None:
        for each in guide:
            self.live[each] = False
            where = self.guides.index[each, self.at[each]]
            self.ends[each] = (
                ending,
                f"stopped at configuration {where} of the guide path: {reason}",
            )
