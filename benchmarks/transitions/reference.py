"""The reference's transitions: three phases of a biped, with verdicts of two programs by others."""

import gzip
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from jaxleas.dynamics import BoundaryState, Limits, Reach, Supports, Transitions

_CORNERS = ((1, 1), (1, -1), (-1, 1), (-1, -1))
_NO_ROW = 10.0  # bound of a padded row [m]


@dataclass(frozen=True)
class Verdicts:
    """Transitions with a verdict on which both other programs agree.

    Attributes:
        transitions: transitions, one batch axis.
        feasible: verdict of each.
        names: entry and durations of each.
    """

    transitions: Transitions
    feasible: np.ndarray
    names: list[str]


def read_verdicts(file: Path, kind: str) -> Verdicts:
    """Read the entries that the published library and the independent program agree on.

    Args:
        file: croc.json.gz.
        kind: `continuous` for limits that hold at all times, `disc_dt0p05` for instants 0.05 s
            apart.
    """
    with gzip.open(file) as stream:
        entries = json.load(stream)
    found: list[tuple[dict[str, Any], list[float], bool]] = []
    for entry in entries:
        for result in entry["results"]["per_timing"]:
            verdict = result[f"real_{kind}"]
            if verdict == result[f"indep_{kind}"]:
                found.append((entry, result["Ts"], verdict))
    points = max(_points(phase)[0].shape[0] for entry, *_ in found for phase in entry["phases"])
    rows = max(len(phase["Kin"]) for entry, *_ in found for phase in entry["phases"])
    each = [_transition(entry, durations, points, rows) for entry, durations, _ in found]
    return Verdicts(
        _stack(each),
        np.array([verdict for *_, verdict in found]),
        [f"{entry['id']} {durations}" for entry, durations, _ in found],
    )


def _stack(each: list[Any]) -> Any:
    first = each[0]
    if isinstance(first, tuple):
        return type(first)(*(_stack(list(part)) for part in zip(*each, strict=True)))
    return np.array(each)


def _transition(
    entry: dict[str, Any], durations: list[float], points: int, rows: int
) -> Transitions:
    supports, reach = [], []
    for phase in entry["phases"]:
        where, normals, ahead = _points(phase)
        missing = points - len(where)
        pad = ((0, missing), (0, 0))
        standing = np.arange(points) < len(where)
        supports.append((np.pad(where, pad), np.pad(normals, pad), np.pad(ahead, pad), standing))
        spare = rows - len(phase["Kin"])
        bounds = np.pad(np.array(phase["kin"]), (0, spare), constant_values=_NO_ROW)
        reach.append((np.pad(np.array(phase["Kin"]), ((0, spare), (0, 0)))[None], bounds[None]))
    start, end = [
        BoundaryState(
            *(np.array(entry[name.format(k)], np.float64) for name in ("c{}", "dc{}", "ddc{}"))
        )
        for k in (0, 1)
    ]
    return Transitions(
        start,
        end,
        np.array(durations),
        Supports(*(np.array(part) for part in zip(*supports, strict=True))),
        Reach(*(np.array(part) for part in zip(*reach, strict=True))),
        Limits(
            friction=np.float64(entry["mu"]), acceleration=np.float64(10.0), force=np.float64(100.0)
        ),
    )


def _points(phase: dict[str, Any]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return points, normals and first axes: zeros, as its pyramids are aligned with the world."""
    where, normals = [], []
    for contact in phase["contacts"]:
        turn, half = np.array(contact["R"]), contact["half"]
        for corner in _CORNERS if any(half) else ((0, 0),):
            local = np.array([corner[0] * half[0], corner[1] * half[1], 0.0])
            where.append(np.array(contact["p"]) + turn @ local)
            normals.append(turn[:, 2] / np.linalg.norm(turn[:, 2]))
    return np.array(where), np.array(normals), np.zeros((len(where), 3))
