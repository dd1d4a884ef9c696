"""A straight obstacle across a course, as numbers."""

import math
from dataclasses import astuple, dataclass, replace


@dataclass(frozen=True)
class Bar:
    """An upright box that stands or hangs in an obstacle.

    Attributes:
        thickness: size across the obstacle [m]; the box is centred on its line.
        length: size along the obstacle [m]; infinite: from side to side of the course.
        bottom: height of the underside [m].
        top: height of the top [m].
    """

    thickness: float
    length: float
    bottom: float
    top: float


@dataclass(frozen=True)
class Limit:
    """A straight obstacle, in its own frame: x across it, y along it, the ground before it at 0.

    Attributes:
        rise: height of the ground behind [m]; negative: it lies lower.
        gap: width of the void between the ground before and behind [m].
        bars: boxes above the line between the two grounds.
        period: distance between bars of finite length along the obstacle [m].
    """

    rise: float = 0.0
    gap: float = 0.0
    bars: tuple[Bar, ...] = ()
    period: float = math.inf

    @property
    def uniform(self) -> bool:
        """Return whether the obstacle is as high everywhere along its line."""
        endless = [bar for bar in self.bars if math.isinf(bar.length)]
        return all(
            any(other.top >= bar.top and other.thickness >= bar.thickness for other in endless)
            for bar in self.bars
        )

    def scaled(self, factor: float) -> "Limit":
        """Return the obstacle with every length multiplied by `factor`."""
        return Limit(
            rise=factor * self.rise,
            gap=factor * self.gap,
            bars=tuple(Bar(*(factor * size for size in astuple(bar))) for bar in self.bars),
            period=factor * self.period,
        )

    def worse(self, spare: float) -> "Limit":
        """Return the obstacle with every size larger, so that less room is left, by `spare` [m]."""
        return Limit(
            rise=self.rise + math.copysign(spare, self.rise) if self.rise else 0.0,
            gap=self.gap + spare if self.gap else 0.0,
            bars=tuple(_larger(bar, spare) for bar in self.bars),
            period=self.period,
        )


def _larger(bar: Bar, spare: float) -> Bar:
    return replace(
        bar, thickness=bar.thickness + spare, length=bar.length + spare, top=bar.top + spare
    )
