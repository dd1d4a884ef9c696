"""A guide path: timed root poses, which can be cut, joined and measured."""

from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Any, Protocol

import numpy as np
from jaxtyping import Bool, Float, Int


class RootMotions(Protocol):
    """The recorded root motions of N walks, robot first: a `RootMotion`, a roll-out, ..."""

    @property
    def position(self) -> Any:
        """Positions of the roots in the world, [N, T, 3] [m]."""

    @property
    def yaw(self) -> Any:
        """Headings, [N, T] [rad]."""

    @property
    def velocity(self) -> Any:
        """Velocities of the roots in the world, [N, T, 3] [m/s]."""


@dataclass(frozen=True)
class GuidePath:
    """A guide path of one query, as plain NumPy values.

    Attributes:
        time: time since the start [s].
        position: position of the root in the world [m].
        yaw: heading [rad].
        velocity: velocity of the root in the world [m/s].
        valid: whether each configuration satisfies the conditions it was judged by.
    """

    time: Float[np.ndarray, " T"]
    position: Float[np.ndarray, "T 3"]
    yaw: Float[np.ndarray, " T"]
    velocity: Float[np.ndarray, "T 3"]
    valid: Bool[np.ndarray, " T"]

    def __len__(self) -> int:
        """Return the number of configurations."""
        return len(self.time)

    def __getitem__(
        self, rows: slice | Int[np.ndarray, " M"] | Bool[np.ndarray, " T"]
    ) -> "GuidePath":
        """Return the path of selected configurations, which keep their times.

        Args:
            rows: slice, indices or mask of the configurations to keep.
        """
        return GuidePath(*(getattr(self, each.name)[rows] for each in fields(self)))

    @property
    def distance(self) -> Float[np.ndarray, " T"]:
        """Distance that the root has travelled up to each configuration [m]."""
        return np.concatenate([[0.0], np.cumsum(self._moved)])[: len(self)]

    @property
    def length(self) -> float:
        """Distance travelled by the root [m]."""
        return float(self._moved.sum())

    @property
    def _moved(self) -> Float[np.ndarray, " T-1"]:
        return np.linalg.norm(np.diff(np.asarray(self.position, np.float64), axis=0), axis=1)

    @classmethod
    def of_walk(
        cls, motions: RootMotions, valid: Bool[np.ndarray, "N T"], walk: int, time_step: float
    ) -> "GuidePath":
        """Return one recorded walk in its full length.

        Args:
            motions: root motions of all walks, on the host.
            valid: whether each of their configurations is valid.
            walk: index of the walk.
            time_step: time between two configurations [s].
        """
        return cls(
            time=np.arange(len(valid[walk])) * time_step,
            position=motions.position[walk],
            yaw=motions.yaw[walk],
            velocity=motions.velocity[walk],
            valid=valid[walk],
        )

    @classmethod
    def join(cls, parts: Sequence["GuidePath"]) -> "GuidePath":
        """Return several paths as one whose clock starts at zero.

        Each path begins at the last configuration of the previous one, which is kept once.

        Args:
            parts: paths, at least one, in order.
        """
        rows = {
            each.name: np.concatenate(
                [getattr(part, each.name)[min(index, 1) :] for index, part in enumerate(parts)]
            )
            for each in fields(cls)
        }
        gaps = np.concatenate([np.diff(part.time) for part in parts])
        return cls(**rows | {"time": np.concatenate([[0.0], np.cumsum(gaps)])})


def cut_walks(
    motions: RootMotions,
    valid: Bool[np.ndarray, "N T"],
    counts: Int[np.ndarray, " N"],
    time_step: float,
) -> list[GuidePath]:
    """Return each of N recorded walks as a guide path that ends where the walk ends.

    Args:
        motions: root motions of all walks, on the host.
        valid: whether each of their configurations is valid.
        counts: number of configurations of each walk; later records are left out.
        time_step: time between two configurations [s].
    """
    return [
        GuidePath.of_walk(motions, valid, walk, time_step)[:count]
        for walk, count in enumerate(np.asarray(counts).tolist())
    ]
