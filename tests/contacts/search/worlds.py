"""Random problems with yaws, slopes and feet that move twice, and a slow twin by SciPy."""

import itertools

import numpy as np
from scipy.optimize import linprog

from benchmarks.contacts.flat_worlds import boxes

ENOUGH = 1e-4  # room that settles that there is a plan [m]


def tilted_world(seed: int, model: str, steps: int = 4, twice: bool = False) -> dict:
    """Return a problem of small tilted surfaces; the feet alternate unless one may move twice."""
    rng = np.random.default_rng(seed)
    surfaces = {"start": _quad(rng, np.array([-0.1, 0.0, 0.0]), 0.5)}
    for index in range(4):
        middle = np.array([rng.uniform(0.05, 0.8), rng.uniform(-0.3, 0.3), rng.uniform(-0.1, 0.15)])
        surfaces[f"s{index}"] = _quad(rng, middle, rng.uniform(0.15, 0.4))
    names, feet = list(surfaces), ["LF", "RF"]
    order = [feet[index % 2] for index in range(steps)]
    while twice and all(one != other for one, other in itertools.pairwise(order)):
        order = [feet[int(rng.integers(2))] for _ in range(steps)]
    yaws = np.cumsum(rng.uniform(-0.35, 0.35, size=steps))
    chosen = [list(rng.choice(names, size=2, replace=False)) for _ in range(steps - 1)]
    polytopes = boxes(rise=0.25)
    for name in ("COM_in_LF", "COM_in_RF"):  # narrow enough to matter, and no box
        side = 1.0 if name.endswith("RF") else -1.0
        rows = [*polytopes[name]["A"], [0.6, 0.0, 0.8], [-0.6, 0.0, 0.8], [0.0, 0.8 * side, 0.6]]
        polytopes[name] = {
            "A": rows,
            "b": [0.2, 0.2, 0.22, 0.22, 0.95, -0.7, 0.78, 0.78, 0.66],
        }
    return {
        "robot": "talos",
        "model": model,
        "surfaces": surfaces,
        "initial": {
            "LF": {"position": _on(surfaces["start"], 0.0, 0.1), "yaw": 0.1},
            "RF": {"position": _on(surfaces["start"], 0.0, -0.1), "yaw": -0.1},
        },
        "phases": [
            {"foot": foot, "yaw": float(yaw), "candidates": [str(n) for n in each], "root": None}
            for foot, yaw, each in zip(order, yaws, [*chosen, [f"s{rng.integers(4)}"]], strict=True)
        ],
        "polytopes": polytopes,
        "foot_half_size": [0.1, 0.06],
    }


def _quad(rng: np.random.Generator, middle: np.ndarray, size: float) -> list[list[float]]:
    """Return a rectangle of half that size about a point, turned and tilted by up to 20 degrees."""
    angle, tilt = rng.uniform(0, np.pi), rng.uniform(-0.35, 0.35, size=2)
    corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * size * rng.uniform(0.4, 1.0, size=2)
    cosine, sine = np.cos(angle), np.sin(angle)
    flat = corners @ np.array([[cosine, sine], [-sine, cosine]])
    return (np.column_stack([flat, flat @ tilt]) + middle).tolist()


def _on(corners: list[list[float]], x: float, y: float) -> list[float]:
    """Return the point of a plane above or below a place."""
    points = np.array(corners)
    slope = np.linalg.lstsq(np.column_stack([points[:, :2], np.ones(4)]), points[:, 2])[0]
    return [x, y, float(slope @ [x, y, 1.0])]


def turn(yaw: float) -> np.ndarray:
    """Return the rotation from a foot's frame to the world."""
    return np.array([[np.cos(yaw), -np.sin(yaw), 0], [np.sin(yaw), np.cos(yaw), 0], [0, 0, 1]])


def slow_twin(described: dict) -> float:
    """Return the room that a choice of surfaces leaves: one choice after the other, a program each.

    The room is the least slack of all reaches [m]; negative: there is no plan. Feet are convex
    combinations of their surfaces' corners, so that no half-space of a surface is computed.
    """
    choices = itertools.product(*(phase["candidates"] for phase in described["phases"]))
    best = -np.inf
    for names in choices:
        best = max(best, _room(described, names))
        if best > ENOUGH:
            break
    return best


def _room(described: dict, names: tuple[str, ...]) -> float:
    corners = [np.array(described["surfaces"][name]) for name in names]
    count, com = len(names), described["model"] == "two_com"
    starts = np.cumsum([0, *(len(each) for each in corners)])
    width = starts[-1] + 6 * count + 1
    feet = {n: (_constant(p["position"], width), p["yaw"]) for n, p in described["initial"].items()}
    A, b = [], []

    def require(polytope, frame, vector):  # A R' vector <= b - room
        rows = np.array(polytope["A"], float) @ frame.T
        length = np.linalg.norm(rows, axis=1)
        matrix, constant = vector
        block = rows @ matrix
        block[:, -1] += length
        A.extend(block)
        b.extend(np.array(polytope["b"], float) - rows @ constant)

    for k, phase in enumerate(described["phases"]):
        foot, other = phase["foot"], "RF" if phase["foot"] == "LF" else "LF"
        matrix = np.zeros((3, width))
        matrix[:, starts[k] : starts[k + 1]] = corners[k].T
        landed, landed_yaw = (matrix, np.zeros(3)), phase["yaw"]
        stood, yaw = feet[other]
        sets = described["polytopes"]
        if not com:
            require(sets[f"{other}_in_{foot}"], turn(landed_yaw), _minus(stood, landed))
        else:
            require(sets[f"{foot}_in_{other}"], turn(yaw), _minus(landed, stood))
            half = np.repeat(described["foot_half_size"], 2)
            sole = {"A": [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0]], "b": half}
            for number in (0, 1):
                place = np.zeros((3, width))
                begin = starts[-1] + 6 * k + 3 * number
                place[:, begin : begin + 3] = np.eye(3)
                away = [
                    (_minus((place, np.zeros(3)), each), turn(angle), name)
                    for each, angle, name in ((stood, yaw, other), (landed, landed_yaw, foot))
                ]
                for vector, frame, name in away:
                    require(sets[f"COM_in_{name}"], frame, vector)
                require(sole, away[number][1], away[number][0])
        feet[foot] = landed, landed_yaw
    equal = np.zeros((count, width))
    for k in range(count):
        equal[k, starts[k] : starts[k + 1]] = 1.0
    cost = np.zeros(width)
    cost[-1] = -1.0
    bounds = [(0, None)] * int(starts[-1]) + [(None, None)] * (6 * count) + [(None, 0.05)]
    answer = linprog(cost, np.array(A), b, equal, np.ones(count), bounds=bounds)
    assert answer.status == 0
    return -float(answer.fun)


def _constant(point, width: int) -> tuple[np.ndarray, np.ndarray]:
    return np.zeros((3, width)), np.array(point)


def _minus(one, other):
    return one[0] - other[0], one[1] - other[1]
