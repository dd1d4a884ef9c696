"""Contacts along guide paths, from each kept configuration to the next."""

import math
from collections.abc import Sequence
from time import perf_counter

import numpy as np

from jaxleas.contacts.sampling.case import PlanningCase
from jaxleas.contacts.sampling.create import Created, create_contacts
from jaxleas.contacts.sampling.diary import Diary
from jaxleas.contacts.sampling.explanation import explain_feet
from jaxleas.contacts.sampling.first_stance import first_stances
from jaxleas.contacts.sampling.guides import KeptGuides, keep_configurations
from jaxleas.contacts.sampling.maintain import maintain_contacts
from jaxleas.contacts.sampling.move import Move
from jaxleas.contacts.sampling.plan import Ending, How, SamplingPlan
from jaxleas.contacts.sampling.stance import put
from jaxleas.types import GuidePath

_LOOK = 3  # configurations at which contacts are judged together; most last that long


class GuideFollower:
    """The feet of one robot along each of several guide paths, planned together.

    Contacts are kept while possible; else one is broken and made anew; else one is repositioned.

    Attributes:
        at: index of the kept configuration that each path has reached.
        failures: number of failures in a row of each path.
        repositions: number of repositions of each path.
        live: whether each path is still followed.
        ends: way in which each path ends, and the sentence that says why.
        stances: stance at the configuration that each path has reached.
    """

    def __init__(
        self,
        case: PlanningCase,
        guide_paths: Sequence[GuidePath],
        scene_index: Sequence[int],
        deadline: float = math.inf,
    ) -> None:
        """Prepare the guide paths.

        Args:
            case: robot, scenes, settings.
            guide_paths: guide paths to follow exactly, at least one, each of them usable.
            scene_index: index of the scene that each path is in.
            deadline: time after which all paths end, by `perf_counter` [s].
        """
        self.begun, self.deadline = perf_counter(), deadline
        self.case = case
        self.guides: KeptGuides = keep_configurations(case, guide_paths, scene_index)
        count = len(guide_paths)
        self.at = np.zeros(count, dtype=np.int64)
        self.failures = np.zeros(count, dtype=np.int64)
        self.repositions = np.zeros(count, dtype=np.int64)
        self.order = np.full(count, len(case.legs))
        self.live = np.ones(count, dtype=bool)
        self.ends: list[tuple[Ending, str]] = [("reached", "")] * count
        self.diary = Diary()

    def plans(self) -> list[SamplingPlan]:
        """Follow all paths to their ends, or until the deadline."""
        self._start()
        while self.live.any():
            if perf_counter() > self.deadline:
                self._stop(np.flatnonzero(self.live), "time_limit", "its time is over")
                break
            blocked, can_stay = self._go_on()
            if len(blocked):
                failed = self._step(blocked, can_stay)
                self._reposition(failed)
        return self.diary.plans(self.case, self.guides, self.ends, self.begun)

    def why_stopped(self) -> str:
        """Return why each foot of the first path makes no contact at its next configuration."""
        return explain_feet(self.case, self.guides, self.stances, int(self.at[0]) + 1)

    def _start(self) -> None:
        first = first_stances(self.case, self.guides)
        self.stances = first.stances
        free = self.guides.trunk_free[:, 0]
        both = "both" if self.limbs == 2 else "all"
        self._stop(
            np.flatnonzero(~free), "trunk", "the trunk touches the scene at the first configuration"
        )
        self._stop(
            np.flatnonzero(free & ~first.found),
            "no_start",
            f"no robust stance with {both} feet exists at the first configuration",
        )
        good = np.flatnonzero(first.found & free)
        self.diary.write(
            "start", good, self.at[good], -1, self.stances[good], first.com[good]
        )  # fmt: skip
        self._finish(good)

    def _go_on(self) -> tuple[np.ndarray, np.ndarray]:
        """Keep contacts while possible; return the blocked paths, and the legs that can stay."""
        going = np.flatnonzero(self.live)
        ahead = self.at[going, None] + 1 + np.arange(_LOOK)
        exists = ahead < self.guides.length[going, None]
        row, look = np.nonzero(exists)
        guide, at = going[row], ahead[row, look]
        kept = maintain_contacts(
            self.case, self.guides.roots[self.guides.flat(guide, at)], self.stances[guide]
        )
        good = np.zeros(exists.shape, dtype=bool)
        good[row, look] = kept.whole & self.guides.trunk_free[guide, at]
        good = np.logical_and.accumulate(good, axis=1)
        taken = good[row, look]
        self.diary.write(
            "kept", guide[taken], at[taken], -1, self.stances[guide[taken]],
            kept.com[taken],
        )  # fmt: skip
        progress = good.sum(axis=1)
        self.at[going] += progress
        self.failures[going[progress > 0]] = 0
        self._finish(going)
        stuck = (progress < _LOOK) & self.live[going]
        position = np.zeros(exists.shape, dtype=np.int64)
        position[row, look] = np.arange(len(row))
        where = position[np.flatnonzero(stuck), progress[stuck]]
        blocked, can_stay = going[stuck], kept.limb[where]
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
        settings = self.case.settings
        # With two feet one reposition mends a failure; with more, every other foot may need one.
        most = (settings.max_tries - 1) * (self.limbs - 1) + 1
        enough = self.failures[failed] >= most
        self._stop(
            failed[enough],
            "no_contact",
            f"{self._no_foot} finds a contact that leads on to the next configuration, nor after "
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
            f"{self._no_foot} finds a contact that leads on to the next configuration, nor can one"
            " be repositioned",
        )

    def _by_age(self, guide: np.ndarray, turn: int) -> np.ndarray:
        """Return the limb with the oldest contact (turn 0), the next one (turn 1), and so on."""
        return np.argsort(self.stances.since[guide], axis=1, kind="stable")[:, turn]

    @property
    def _no_foot(self) -> str:
        return "neither foot" if self.limbs == 2 else "no foot"

    @property
    def limbs(self) -> int:
        """Number of limbs that move."""
        return self.stances.since.shape[1]

    def _create(
        self, guide: np.ndarray, at: np.ndarray, limb: np.ndarray, least_move: float
    ) -> Created:
        aim = self.guides.aim(guide, at, limb)
        move = Move(aim, self.stances[guide], self.order[guide], least_move)
        return create_contacts(self.case, move)

    def _accept(
        self, how: How, guide: np.ndarray, limb: np.ndarray, made: Created, at: np.ndarray
    ) -> np.ndarray:
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
