"""The numbers of the tile generator (T 3.3.2 and the author's published arenas), all named."""

from typing import Annotated

from pydantic import AfterValidator, Field, PositiveFloat, model_validator

from jaxleas.configuration.bounds import Fraction
from jaxleas.configuration.strict import Strict


def _ordered(interval: tuple[float, float]) -> tuple[float, float]:
    if interval[0] > interval[1]:
        raise ValueError(
            f"the interval's low end {interval[0]:g} is above its high {interval[1]:g}"
        )
    return interval


Interval = Annotated[tuple[PositiveFloat, PositiveFloat], AfterValidator(_ordered)]


class ObstaclesConfig(Strict):
    """Boxes on initial tiles."""

    probability: Fraction = 0.5
    """that an initial tile carries boxes"""
    count: Annotated[int, Field(ge=1, le=4)] = 1
    """boxes a tile, each in a quarter of its own"""
    length: Interval = (0.15, 0.5)
    """first side of a box [m]"""
    width: Interval = (0.15, 0.67)
    """second side of a box [m]"""
    height: Interval = (0.7, 2.0)
    """above the tile [m]"""
    distance: Interval = (0.3, 0.5)
    """from the tile's centre to the box, along each axis [m]"""


class RubbleConfig(Strict):
    """Transition of tilted rectangles."""

    cell: Interval = (0.35, 0.45)
    """side of a rectangle [m]"""
    rise: PositiveFloat = 0.05
    """largest rise from a rectangle's centre to an edge, along each axis [m]"""


class BridgeConfig(Strict):
    """Transition over one rectangle, level or sloped."""

    wide_probability: Fraction = 0.3
    wide: Interval = (1.8, 2.0)
    """width of a wide bridge [m]"""
    narrow: Interval = (0.30, 0.45)
    """width of a narrow bridge [m]"""
    sloped_probability: Fraction = 0.5
    """that a bridge into the empty climbs or falls"""
    rise: PositiveFloat = 0.15
    """largest climb or fall of a bridge into the empty [m]"""


class StairsConfig(Strict):
    """Transition of steps with equal risers."""

    climb: Interval = (0.4, 1.0)
    """height climbed by stairs into the empty [m]"""
    depth: Interval = (0.2, 0.4)
    """of a step [m]"""
    width: Interval = (1.67, 2.0)
    """of a step [m]"""
    riser_max: PositiveFloat = 0.2
    """highest single step [m]: a robot of Talos's size climbs it"""
    slope_max: PositiveFloat = 0.65
    """climb over run of stairs between landings: 33 degrees, as steep as buildings have"""
    landing_probability: Fraction = 0.3
    """that the steps do not fill the tile: fewer, higher ones between two flat landings"""


class DetourConfig(Strict):
    """Level transition that has to be walked round: a hole in the ground, or a wall across it."""

    length: Interval = (0.3, 1.6)
    """of the hole along the crossing [m]"""
    thickness: Interval = (0.15, 0.4)
    """of the wall [m]"""
    height: Interval = (0.7, 2.0)
    """of the wall above the tile [m]"""
    width: Interval = (0.5, 1.1)
    """of the hole or wall across the crossing [m]: from anywhere before it a way round lies within
    the 0.6 m that a local policy sees to a side"""
    rim: PositiveFloat = 0.45
    """of the ground beside the hole, at either side at least [m]"""


class GeneratorConfig(Strict):
    """An arena of tiles: initial ones (flat, obstacles) joined by transitions."""

    rows: Annotated[int, Field(ge=1, le=200)] = 5
    """tiles along y"""
    columns: Annotated[int, Field(ge=1, le=200)] = 5
    """tiles along x"""
    tile_size: Annotated[float, Field(ge=1.2, le=10.0)] = 2.0
    """edge of a tile [m]"""
    inset: Annotated[float, Field(ge=0.0, le=0.02)] = 0.01
    """by which every contact rectangle is smaller a side [m]"""
    transition_probability: Fraction = 0.8
    """that an initial tile is followed by a transition; else by another initial tile"""
    dead_end_probability: Fraction = 0.3
    """that a transition which cannot be continued is built all the same, and leads nowhere"""
    detour_probability: Fraction = 0.0
    """that a transition into the empty is a hole or a wall; the thesis's generator has none"""
    stairs_probability: Fraction = 0.55
    """that a transition into the empty is stairs"""
    bridge_probability: Fraction = 0.30
    """that a transition into the empty is a bridge; what is left is rubble"""
    bridge_only_below: PositiveFloat = 0.15
    """two initial tiles of a smaller height difference are joined by a bridge [m]"""
    bridge_below: PositiveFloat = 0.25
    """two initial tiles of a smaller height difference are joined by a bridge or stairs [m]"""
    stairs_below: PositiveFloat = 1.0
    """two initial tiles of a smaller height difference are joined by stairs, else not [m]"""
    cliff_above: PositiveFloat = 0.4
    """initial tiles side by side with a larger height difference are a dead end [m]"""
    level_below: PositiveFloat = 0.1
    """initial tiles in a row with smaller height differences are a flat link [m]"""
    obstacles: ObstaclesConfig = ObstaclesConfig()
    rubble: RubbleConfig = RubbleConfig()
    bridge: BridgeConfig = BridgeConfig()
    stairs: StairsConfig = StairsConfig()
    detour: DetourConfig = DetourConfig()

    @model_validator(mode="after")
    def _odds_leave_room(self) -> "GeneratorConfig":
        if self.stairs_probability + self.bridge_probability > 1.0 + 1e-9:
            raise ValueError("stairs_probability and bridge_probability sum to more than 1")
        return self
