"""Guide paths as files (docs/files.md)."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, get_args

import numpy as np

from jaxleas.files import read_npz, require_version_array, write_npz
from jaxleas.guide.failures import Failure, failures_from_arrays, failures_to_arrays
from jaxleas.guide.query_file import read_queries, require_on_terrain
from jaxleas.robots import RecordedRobot
from jaxleas.types import Ending, GuidePath, InputError, ending_of

__all__ = [
    "GuidePathFile",
    "Reason",
    "read_guide_paths",
    "read_queries",
    "require_on_terrain",
    "write_guide_paths",
]

Reason = Literal["reached", "invalid", "stopped"]

VERSION = 1  # version of guide path files


@dataclass(frozen=True)
class GuidePathFile:
    """Guide paths and how each ended.

    Attributes:
        paths: one guide path for each query.
        reasons: reason why each path ended; empty when the file does not say.
        robot: robot that walked; None in files from before robots were recorded.
        failures: what is wrong with the last configuration of each path; empty when the file does
            not say.
    """

    paths: tuple[GuidePath, ...]
    reasons: tuple[Reason, ...]
    robot: RecordedRobot | None = None
    failures: tuple[Failure | None, ...] = ()

    @property
    def endings(self) -> tuple[Ending, ...]:
        """How each path ended, as far as the file says."""
        said = self.reasons or ("",) * len(self.paths)
        return tuple(ending_of(path, each) for path, each in zip(self.paths, said, strict=True))


def write_guide_paths(
    path: str | Path,
    guide_paths: Sequence[GuidePath],
    reasons: Sequence[Reason],
    waypoints: np.ndarray | None = None,
    robot: str | None = None,
    failures: Sequence[Failure | None] | None = None,
) -> None:
    """Write guide paths end to end as .npz, whole or not at all.

    Args:
        path: file to write.
        guide_paths: one guide path for each query.
        reasons: reason why each path ended.
        waypoints: waypoints x and y of a single path, the goal last [m]; not read back.
        robot: name of the robot that walked, or path of its file; None: it is not recorded.
        failures: what is wrong with the last configuration of each path; None: it is not recorded.
    """
    recorded = {} if robot is None else RecordedRobot.of(robot).to_arrays()
    lengths = [len(each) for each in guide_paths]
    write_npz(
        path,
        time=np.concatenate([each.time for each in guide_paths]).astype(np.float64),
        position=np.concatenate([each.position for each in guide_paths]).astype(np.float32),
        yaw=np.concatenate([each.yaw for each in guide_paths]).astype(np.float32),
        velocity=np.concatenate([each.velocity for each in guide_paths]).astype(np.float32),
        valid=np.concatenate([each.valid for each in guide_paths]).astype(bool),
        query=np.repeat(np.arange(len(lengths)), lengths),
        reached=np.array([reason == "reached" for reason in reasons]),
        reason=np.array(reasons, dtype=np.str_),
        version=np.array(VERSION),
        **recorded,
        **({} if failures is None else failures_to_arrays(failures)),
        **({} if waypoints is None else {"waypoints": np.asarray(waypoints, np.float64)}),
    )


def read_guide_paths(path: str | Path) -> GuidePathFile:
    """Read guide paths; a file without `query` is one path.

    Raises:
        InputError: the file lacks an array, or its arrays do not fit together.
    """
    required = ("time", "position", "yaw", "velocity", "valid")
    arrays = read_npz(path, required)
    require_version_array(arrays, VERSION, path)
    rows = arrays["time"].shape[0] if arrays["time"].ndim else 0
    shapes = {"position": (rows, 3), "velocity": (rows, 3)}
    arrays.setdefault("query", np.zeros(rows, np.int64))
    for name in (*required, "query"):
        kinds = {"valid": "b", "query": "iu"}.get(name, "f")
        expected = shapes.get(name, (rows,))
        array = arrays[name]
        if rows == 0 or array.shape != expected or array.dtype.kind not in kinds:
            raise InputError(
                f"{path}: {name} is {array.dtype} {array.shape}, where a guide path of {rows} rows"
                f" has shape {expected}"
            )
        if array.dtype.kind == "f" and not np.isfinite(array).all():
            raise InputError(f"{path}: {name} holds values that are not finite")
    first = np.flatnonzero(np.diff(arrays["query"], prepend=arrays["query"][0] - 1))
    if not np.array_equal(arrays["query"][first], np.arange(len(first))):
        raise InputError(f"{path}: query must count 0, 1, 2, ... through the rows")
    reasons = arrays.get("reason", np.array([], np.str_))
    if (
        reasons.ndim != 1
        or len(reasons) not in (0, len(first))
        or not set(reasons.tolist()) <= set(get_args(Reason))
    ):
        raise InputError(
            f"{path}: reason must say one of {', '.join(get_args(Reason))} for each of the"
            f" {len(first)} paths"
        )
    columns = [np.split(arrays[name], first[1:]) for name in required]
    guide_paths = tuple(GuidePath(*parts) for parts in zip(*columns, strict=True))
    return GuidePathFile(
        guide_paths,
        tuple(reasons.tolist()),
        RecordedRobot.from_arrays(arrays, path),
        failures_from_arrays(arrays, len(guide_paths), path),
    )
