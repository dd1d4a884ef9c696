"""What a phase tracker follows: support phases of many robots, with their curves and swings."""

from dataclasses import dataclass, fields
from math import comb
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int


class Reference(NamedTuple):
    """Where N robots are to be at their plans' times.

    Attributes:
        com: centre of mass [m].
        velocity: velocity of the centre of mass [m/s].
        acceleration: acceleration of the centre of mass [m/s2].
        yaw: heading, which never jumps [rad].
        yaw_rate: turning rate [rad/s].
        support: number of the support phase.
        stands: whether each foot is to stand.
    """

    com: Float[np.ndarray, "N 3"]
    velocity: Float[np.ndarray, "N 3"]
    acceleration: Float[np.ndarray, "N 3"]
    yaw: Float[np.ndarray, " N"]
    yaw_rate: Float[np.ndarray, " N"]
    support: Int[np.ndarray, " N"]
    stands: Bool[np.ndarray, "N E"]


@dataclass(frozen=True, eq=False)
class Swings:
    """The swing that each foot of N robots makes in each of K + 1 supports; none where it stands.

    Attributes:
        first: number of the support in which it began; -1 for none.
        begin: when the foot is lifted [s].
        end: when it is to stand again [s].
        touchdown: where its middle is then [m].
        top: height that its middle rises to on its way [m].
    """

    first: Int[np.ndarray, "N K+1 E"]
    begin: Float[np.ndarray, "N K+1 E"]
    end: Float[np.ndarray, "N K+1 E"]
    touchdown: Float[np.ndarray, "N K+1 E 3"]
    top: Float[np.ndarray, "N K+1 E"]


@dataclass(frozen=True, eq=False)
class PhaseTracks:
    """Plans of N robots with E feet, of up to K transitions; shorter ones are padded.

    Attributes:
        lengths: number of transitions of each plan.
        begins: when each transition begins, and last when the plan ends [s]; equal from there on.
        switches: when each support begins [s]; infinity for those that never do.
        curves: control points of the centre of mass in each transition [m].
        yaws: heading at the beginning of each transition, which turns evenly [rad].
        stands: whether a foot is to stand in a support.
        feet: middle of each foot in each support [m].
        swings: swings.
    """

    lengths: Int[np.ndarray, " N"]
    begins: Float[np.ndarray, "N K+1"]
    switches: Float[np.ndarray, "N K+1"]
    curves: Float[np.ndarray, "N K P 3"]
    yaws: Float[np.ndarray, "N K+1"]
    stands: Bool[np.ndarray, "N K+1 E"]
    feet: Float[np.ndarray, "N K+1 E 3"]
    swings: Swings

    def __len__(self) -> int:
        """Return the number of robots."""
        return len(self.lengths)

    @property
    def ends(self) -> Float[np.ndarray, " N"]:
        """When each plan ends [s]."""
        return self.begins[np.arange(len(self)), self.lengths]

    def at(self, time: Float[np.ndarray, " N"]) -> Reference:
        """Return where the robots are to be; at rest before the beginning and after the end.

        Args:
            time: time of each robot's plan [s].
        """
        rows, late = np.arange(len(self)), time[:, None]
        transition = (self.begins[:, 1:] <= late).sum(axis=1)
        transition = np.minimum(transition, self.lengths - 1)
        support = np.minimum((self.switches[:, 1:] <= late).sum(axis=1), self.lengths)
        begin = self.begins[rows, transition]
        lasts = self.begins[rows, transition + 1] - begin
        share = ((time - begin) / lasts).clip(0.0, 1.0)
        moves = ((time >= 0.0) & (time < self.ends)).astype(float)
        points = self.curves[rows, transition]
        first, second = np.diff(points, axis=1), np.diff(points, 2, axis=1)
        degree = points.shape[1] - 1
        speed = moves * degree / lasts
        bend = moves * degree * (degree - 1) / lasts**2
        yaw = self.yaws[rows, transition]
        turn = self.yaws[rows, transition + 1] - yaw
        return Reference(
            _bezier(points, share),
            speed[:, None] * _bezier(first, share),
            bend[:, None] * _bezier(second, share),
            yaw + share * turn,
            moves * turn / lasts,
            support,
            self.stands[rows, support],
        )


def _bezier(
    points: Float[np.ndarray, "N P 3"], share: Float[np.ndarray, " N"]
) -> Float[np.ndarray, "N 3"]:
    """Return points of Bezier curves at shares of their duration."""
    degree = points.shape[1] - 1
    weights = [
        comb(degree, k) * share**k * (1.0 - share) ** (degree - k) for k in range(degree + 1)
    ]
    return (np.stack(weights, axis=1)[..., None] * points).sum(axis=1)


def joined(tracks: list[PhaseTracks]) -> PhaseTracks:
    """Return the tracks of several robots as one; what is shorter is padded.

    Args:
        tracks: tracks of some robots each.
    """
    most = max(each.yaws.shape[1] for each in tracks)

    def together(values: list[np.ndarray], extra: int = 0, fill: float | None = None) -> np.ndarray:
        padded = []
        for value in values:
            width = [(0, 0)] * value.ndim
            width[1] = (0, most - extra - value.shape[1])
            how = {"mode": "edge"} if fill is None else {"constant_values": fill}
            padded.append(np.pad(value, width, **how))  # pyright: ignore
        return np.concatenate(padded)

    def of(name: str) -> list[np.ndarray]:
        return [getattr(each, name) for each in tracks]

    swings = Swings(
        *(
            together([getattr(each.swings, field.name) for each in tracks])
            for field in fields(Swings)
        )
    )
    return PhaseTracks(
        lengths=np.concatenate(of("lengths")),
        begins=together(of("begins")),
        switches=together(of("switches"), fill=np.inf),
        curves=together(of("curves"), extra=1),
        yaws=together(of("yaws")),
        stands=together(of("stands")),
        feet=together(of("feet")),
        swings=swings,
    )
