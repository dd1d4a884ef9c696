"""Labelled paths: guide paths with an exact planner's verdicts, as arrays for a surrogate's fit."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Float, Int

from jaxleas.types import GuidePath, InputError


@dataclass(frozen=True)
class LabelledPaths:
    """N paths at the configurations that the planner was asked about, at most K of each.

    The planner gets from kept configuration to kept configuration until it fails at `failed_at`;
    nothing is known about the configurations after that.

    Attributes:
        position: position of the root in the world [m].
        yaw: heading [rad].
        velocity: velocity of the root in the world [m/s].
        map_index: terrain of each path.
        kept: number of kept configurations.
        known: number of kept configurations with a known verdict.
        failed_at: kept configuration that the planner did not reach; -1 if it reached all.
    """

    position: Float[np.ndarray, "N K 3"]
    yaw: Float[np.ndarray, "N K"]
    velocity: Float[np.ndarray, "N K 3"]
    map_index: Int[np.ndarray, " N"]
    kept: Int[np.ndarray, " N"]
    known: Int[np.ndarray, " N"]
    failed_at: Int[np.ndarray, " N"]

    def __len__(self) -> int:
        """Return the number of paths."""
        return len(self.known)

    @property
    def is_known(self) -> Bool[np.ndarray, "N K"]:
        """Whether the verdict on a kept configuration is known."""
        return np.arange(self.yaw.shape[1])[None] < self.known[:, None]

    @property
    def failed(self) -> Bool[np.ndarray, "N K"]:
        """Whether the planner failed on the way to a kept configuration."""
        return np.arange(self.yaw.shape[1])[None] == self.failed_at[:, None]

    def __getitem__(self, rows: np.ndarray) -> "LabelledPaths":
        """Return some of the paths."""
        return LabelledPaths(**{name: getattr(self, name)[rows] for name in _FIELDS})

    def trimmed(self) -> "LabelledPaths":
        """Return the same paths without the columns that no path reaches."""
        most = int(self.kept.max())
        cut = {name: getattr(self, name)[:, :most] for name in ("position", "yaw", "velocity")}
        return replace(self, **cut)


_FIELDS = tuple(LabelledPaths.__dataclass_fields__)


def label_paths(
    paths: Sequence[GuidePath],
    last_index: Sequence[int],
    map_index: Sequence[int],
    keep_every: int,
    most_kept: int,
) -> LabelledPaths:
    """Turn guide paths and verdicts into arrays.

    Args:
        paths: guide paths to turn into paths.
        last_index: index of the last configuration that the planner reached on each guide path; -1
            for none.
        map_index: terrain of each guide path.
        keep_every: distance, in configurations, between two that the planner was asked about.
        most_kept: maximum number K of kept configurations; longer paths are cut.

    Raises:
        InputError: there is no path, or the numbers do not belong together.
    """
    if not len(paths) == len(last_index) == len(map_index):
        raise InputError(
            f"{len(paths)} guide paths, {len(last_index)} verdicts and {len(map_index)} terrains do"
            " not belong together"
        )
    if not paths:
        raise InputError("there is no guide path to learn from")
    count = np.zeros(len(paths), np.int32)
    known = np.zeros(len(paths), np.int32)
    failed_at = np.full(len(paths), -1, np.int32)
    kept_rows = np.zeros((len(paths), most_kept), np.int64)
    for number, (path, last) in enumerate(zip(paths, last_index, strict=True)):
        kept = np.arange(0, len(path), keep_every)[:most_kept]
        reached = int(np.sum(kept <= last))
        count[number] = len(kept)
        known[number] = min(reached + 1, len(kept))
        if reached < len(kept):
            failed_at[number] = reached
        kept_rows[number] = np.pad(kept, (0, most_kept - len(kept)), mode="edge")

    def gather(name: str) -> np.ndarray:
        rows = zip(paths, kept_rows, strict=True)
        return np.stack([getattr(path, name)[kept] for path, kept in rows]).astype(np.float32)

    return LabelledPaths(
        position=gather("position"),
        yaw=gather("yaw"),
        velocity=gather("velocity"),
        map_index=np.asarray(map_index, np.int32),
        kept=count,
        known=known,
        failed_at=failed_at,
    )


def join(parts: Sequence[LabelledPaths]) -> LabelledPaths:
    """Return several sets of paths as one; their terrains must be numbered in one atlas."""
    return LabelledPaths(
        **{name: np.concatenate([getattr(part, name) for part in parts]) for name in _FIELDS}
    )
