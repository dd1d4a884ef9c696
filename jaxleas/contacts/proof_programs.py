"""Linear programs over one step from a set of places, to verify proofs.

Shares no code with the planners: it reads the problem's value and assembles the constraints as the
format states them (docs/contacts.md). The standing foot is a convex combination of the set's
corners, the landing one of its surface's, so that no half-space of either is computed.
"""

import math
from dataclasses import dataclass

import highspy
import numpy as np
from jaxtyping import Float

from jaxleas.contacts.problem import ContactProblem

_FEASIBILITY = 1e-10  # of rows, by HiGHS [m]
_MOST_ROOM = 1.0  # [m]
_SOLE = np.array([[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -1.0, 0.0]])


@dataclass(frozen=True)
class Stance:
    """The standing foot and the landing one of a step.

    Attributes:
        anchor: name of the foot that stands.
        anchor_yaw: heading with which it stands [rad].
        foot: name of the foot that lands.
        yaw: heading with which it lands [rad].
    """

    anchor: str
    anchor_yaw: float
    foot: str
    yaw: float


def stances_of_steps(problem: ContactProblem) -> list[Stance]:
    """Return the feet of each step of a problem of two feet."""
    yaws = {name: pose.yaw for name, pose in problem.initial.items()}
    stances = []
    for step in problem.steps:
        (anchor,) = (name for name in yaws if name != step.foot)
        stances.append(Stance(anchor, yaws[anchor], step.foot, step.yaw))
        yaws[step.foot] = step.yaw
    return stances


class StepProgram:
    """One step from a set onto a surface: room for it, and how far its places reach.

    Unknown are the weights of the standing foot's corners and of the landing foot's, two places of
    the centre of mass, and the room t: A x + t <= b for each reach, all rows of unit length.
    """

    def __init__(
        self,
        problem: ContactProblem,
        stance: Stance,
        standing: Float[np.ndarray, "v 3"],
        landing: Float[np.ndarray, "w 3"],
    ) -> None:
        self._standing, self._landing = standing, landing
        places = 6 if problem.model == "two_com" else 0
        self._width = len(standing) + len(landing) + places + 1
        self._rows: list[np.ndarray] = []
        self._bounds: list[float] = []
        self._require_reaches(problem, stance)
        self._highs = self._passed()

    def room(self) -> float:
        """Return the room that the best step leaves [m]; negative: no step can be made."""
        cost = np.zeros(self._width)
        cost[-1] = 1.0
        room = self._maximise(cost, -_MOST_ROOM * 1e3)
        assert room is not None
        return room

    def furthest(self, direction: Float[np.ndarray, " 3"], landed: bool) -> float:
        """Return how far in a direction a foot may be before or after a step [m].

        Args:
            direction: direction in the world.
            landed: whether the landing foot is meant, not the standing one.

        Returns:
            Minus infinity where no step can be made.
        """
        cost = np.zeros(self._width)
        corners, columns = (self._landing, 1) if landed else (self._standing, 0)
        begin = columns * len(self._standing)
        cost[begin : begin + len(corners)] = corners @ direction
        far = self._maximise(cost, 0.0)
        return -math.inf if far is None else far

    def _require_reaches(self, problem: ContactProblem, stance: Stance) -> None:
        stood, landed = self._foot(0, self._standing), self._foot(1, self._landing)
        sets, anchor, foot = problem.polytopes, stance.anchor, stance.foot
        if problem.model == "feet":
            reach = sets.relative[f"{anchor}_in_{foot}"]
            self._require(reach.normals, reach.offsets, stance.yaw, stood - landed)
            return
        reach = sets.relative[f"{foot}_in_{anchor}"]
        self._require(reach.normals, reach.offsets, stance.anchor_yaw, landed - stood)
        feet = ((stood, anchor, stance.anchor_yaw), (landed, foot, stance.yaw))
        for number in (0, 1):
            com = np.zeros((3, self._width))
            begin = len(self._standing) + len(self._landing) + 3 * number
            com[:, begin : begin + 3] = np.eye(3)
            for place, name, yaw in feet:
                reach = sets.com[name]
                self._require(reach.normals, reach.offsets, yaw, com - place)
            place, name, yaw = feet[number]  # c0 over the standing foot, c1 over the landed one
            self._require(_SOLE, np.repeat(problem.half_sizes[name], 2), yaw, com - place)

    def _foot(self, number: int, corners: np.ndarray) -> np.ndarray:
        place = np.zeros((3, self._width))
        begin = number * len(self._standing)
        place[:, begin : begin + len(corners)] = corners.T
        return place

    def _require(self, A: np.ndarray, b: np.ndarray, yaw: float, vector: np.ndarray) -> None:
        """Add A R' vector + t <= b, R the rotation by the yaw and rows of unit length."""
        cosine, sine = math.cos(yaw), math.sin(yaw)
        turned = np.stack(
            [cosine * A[:, 0] - sine * A[:, 1], sine * A[:, 0] + cosine * A[:, 1], A[:, 2]], axis=1
        )
        length = np.sqrt((A * A).sum(axis=1))
        rows = (turned @ vector) / length[:, None]
        rows[:, -1] = 1.0
        self._rows.append(rows)
        self._bounds.extend((b / length).tolist())

    def _passed(self) -> highspy.Highs:
        weights = np.zeros((2, self._width))
        here, there = len(self._standing), len(self._landing)
        weights[0, :here] = weights[1, here : here + there] = 1.0
        rows = np.concatenate([*self._rows, weights])
        low = np.concatenate([np.full(len(self._bounds), -np.inf), [1.0, 1.0]])
        high = np.array([*self._bounds, 1.0, 1.0])
        column_low = np.full(self._width, -np.inf)
        column_low[: here + there] = 0.0
        column_high = np.full(self._width, np.inf)
        column_high[-1] = _MOST_ROOM
        count, size = len(rows), rows.size
        highs = highspy.Highs()
        highs.silent()
        for name in ("primal_feasibility_tolerance", "dual_feasibility_tolerance"):
            highs.setOptionValue(name, _FEASIBILITY)
        highs.setOptionValue("threads", 1)
        highs.setOptionValue("presolve", "off")
        highs.passModel(
            self._width, count, size,
            int(highspy.MatrixFormat.kRowwise), int(highspy.ObjSense.kMaximize), 0.0,
            np.zeros(self._width), column_low, column_high, low, high,
            np.arange(0, size + 1, self._width, dtype=np.int32)[:count],
            np.tile(np.arange(self._width, dtype=np.int32), count),
            rows.reshape(-1), np.zeros(self._width, np.int32),
        )  # fmt: skip
        return highs

    def _maximise(self, cost: np.ndarray, least_room: float) -> float | None:
        """Return the greatest value with at least this room; None where there is none."""
        every = np.arange(self._width, dtype=np.int32)
        self._highs.changeColsCost(self._width, every, cost)
        self._highs.changeColBounds(self._width - 1, least_room, _MOST_ROOM)
        self._highs.run()
        status = self._highs.getModelStatus()
        if status == highspy.HighsModelStatus.kOptimal:
            return float(self._highs.getInfo().objective_function_value)
        if status == highspy.HighsModelStatus.kInfeasible:
            return None
        raise ArithmeticError(f"HiGHS ended with {status}")
