"""Small contact problems with known answers, and a NumPy twin that shares no code."""

import gzip
import json
from pathlib import Path

import numpy as np

from benchmarks.contacts.flat_worlds import boxes, content, rectangle
from jaxleas.contacts.problem import ContactProblem
from jaxleas.contacts.problem_file import parse_problem


def stones(gap: float, count: int = 4, rise: float = 0.0, model: str = "two_com") -> dict:
    """Return a start and stepping stones of 0.2 x 0.6 m, `gap` apart; the last is the goal."""
    surfaces = {"start": rectangle(-0.5, 0.1, -0.5, 0.5)}
    for index in range(count):
        x = 0.1 + gap + index * (0.2 + gap)
        z = (index + 1) * rise
        surfaces[f"stone_{index}"] = rectangle(x, x + 0.2, -0.3, 0.3, z)
    names = [f"stone_{index}" for index in range(count)]
    candidates = [["start", *names[: index + 1]] for index in range(count - 1)]
    return content(surfaces, [*candidates, names[-1:]], model)


def problem(described: dict) -> ContactProblem:
    return parse_problem("p.json", json.loads(json.dumps(described)))


def reference_entries(shared: Path) -> list[dict]:
    with gzip.open(shared / "reference/contact-problems.jsonl.gz", "rt") as stream:
        return [json.loads(line) for line in stream]


def reference_problem(shared: Path, entry: dict, model: str) -> ContactProblem:
    sets = json.loads((shared / "data/talos-polytopes.json").read_text())["sets"]
    described = {**entry["problem"], "model": model}
    described["polytopes"] = sets[described["polytopes"]]
    return parse_problem(entry["id"], described)


def moved(described: dict, angle: float, shift: np.ndarray) -> dict:
    """Return the same problem elsewhere: turned about the vertical and shifted."""
    cosine, sine = np.cos(angle), np.sin(angle)
    turn = np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])
    move = lambda point: (turn @ np.array(point) + shift).tolist()  # noqa: E731
    return {
        **described,
        "surfaces": {n: [move(p) for p in each] for n, each in described["surfaces"].items()},
        "initial": {
            foot: {"position": move(pose["position"]), "yaw": pose["yaw"] + angle}
            for foot, pose in described["initial"].items()
        },
        "phases": [{**p, "yaw": p["yaw"] + angle, "root": None} for p in described["phases"]],
    }


def random_world(seed: int, model: str) -> dict:
    rng = np.random.default_rng(seed)
    surfaces = {"start": rectangle(-0.3, 0.15, -0.3, 0.3)}
    for index in range(4):
        x, y = rng.uniform(0.1, 0.9), rng.uniform(-0.35, 0.15)
        size = rng.uniform(0.1, 0.35, size=2)
        surfaces[f"s{index}"] = rectangle(x, x + size[0], y, y + size[1], rng.uniform(-0.1, 0.15))
    names = [f"s{index}" for index in range(4)]
    phases = [["start", *names[:2]], names[:3], names, [names[rng.integers(2, 4)]]]
    described = content(surfaces, phases, model)
    described["polytopes"] = boxes(rise=0.2)
    for each in ("COM_in_LF", "COM_in_RF"):  # narrow enough to matter
        described["polytopes"][each]["b"] = [0.22, 0.22, 0.25, 0.25, 0.95, -0.75]
    return described
