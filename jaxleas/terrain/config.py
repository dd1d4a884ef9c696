"""The configuration of the tile generator (T 3.3.2 and the author's published arenas).

The defaults are the published sizes, which suit Talos; each length carries what it grows with for
another robot (`scale.Follows`).
"""

from typing import Annotated

from pydantic import AfterValidator, Field, PositiveFloat, model_validator

from jaxleas.configuration import Fraction, Strict
from jaxleas.terrain.scale import Follows


def _ordered(interval: tuple[float, float]) -> tuple[float, float]:
    if interval[0] > interval[1]:
        raise ValueError(
            f"the interval's low end {interval[0]:g} is above its high {interval[1]:g}"
        )
    return interval


Interval = Annotated[tuple[PositiveFloat, PositiveFloat], AfterValidator(_ordered)]
LegInterval = Annotated[Interval, Follows.LEG]
WidthInterval = Annotated[Interval, Follows.WIDTH]
BodyInterval = Annotated[Interval, Follows.BODY]
SoleInterval = Annotated[Interval, Follows.SOLE]
LegLength = Annotated[PositiveFloat, Follows.LEG]


class ObstaclesConfig(Strict):
    """Boxes on initial tiles."""

    probability: Fraction = 0.5
    """probability that an initial tile carries boxes"""
    count: Annotated[int, Field(ge=1, le=4)] = 1
    """number of boxes per tile, each in a different quarter"""
    length: LegInterval = (0.15, 0.5)
    """first side of a box [m]"""
    width: LegInterval = (0.15, 0.67)
    """second side of a box [m]"""
    height: LegInterval = (0.7, 2.0)
    """height of a box above the tile [m]"""
    distance: WidthInterval = (0.3, 0.5)
    """distance from the tile's centre to the box, along each axis [m]"""


class RubbleConfig(Strict):
    """Transition of tilted rectangles."""

    cell: SoleInterval = (0.35, 0.45)
    """side of a rectangle [m]"""
    rise: LegLength = 0.05
    """largest rise from a rectangle's centre to an edge, along each axis [m]"""


class BridgeConfig(Strict):
    """Transition over one rectangle, level or sloped."""

    wide_probability: Fraction = 0.3
    wide: BodyInterval = (1.8, 2.0)
    """width of a wide bridge [m]"""
    narrow: WidthInterval = (0.30, 0.45)
    """width of a narrow bridge [m]"""
    sloped_probability: Fraction = 0.5
    """probability that a bridge into an empty cell climbs or falls"""
    rise: LegLength = 0.15
    """largest climb or fall of a bridge into an empty cell [m]"""


class StairsConfig(Strict):
    """Transition of steps with equal risers."""

    climb: LegInterval = (0.4, 1.0)
    """height climbed by stairs into an empty cell [m]"""
    depth: SoleInterval = (0.2, 0.4)
    """depth of a step [m]"""
    width: BodyInterval = (1.67, 2.0)
    """width of a step [m]"""
    riser_max: LegLength = 0.2
    """height of the highest single step [m]"""
    slope_max: PositiveFloat = 0.65
    """climb over run of stairs between landings: 33 degrees, as steep as buildings have"""
    landing_probability: Fraction = 0.3
    """probability that the steps do not fill the tile: fewer, higher ones between two landings"""


class DetourConfig(Strict):
    """Level transition with something to walk around: a hole in the ground, or a wall across it."""

    length: LegInterval = (0.3, 1.6)
    """length of the hole along the crossing [m]"""
    thickness: LegInterval = (0.15, 0.4)
    """thickness of the wall [m]"""
    height: LegInterval = (0.7, 2.0)
    """height of the wall above the tile [m]"""
    width: LegInterval = (0.5, 1.1)
    """width of the hole or wall across the crossing [m]: from anywhere before it, a way around lies
    within the 0.6 m that a local policy sees to each side"""
    rim: Annotated[PositiveFloat, Follows.WIDTH] = 0.45
    """smallest width of the ground on either side of the hole [m]"""


class LimitsConfig(Strict):
    """Transition over a straight obstacle that a robot just can, or just cannot, cross."""

    ledge: LegInterval = (0.25, 0.6)
    """height of a ledge, up or down [m]"""
    gap: LegInterval = (0.1, 0.5)
    """width of a gap [m]"""
    hurdle: LegInterval = (0.1, 0.7)
    """height of a low barrier [m]"""
    wall: LegInterval = (0.7, 2.0)
    """height of a high barrier [m]; half of the barriers are high"""
    thickness: LegInterval = (0.02, 0.3)
    """thickness of a barrier [m]"""
    post: LegInterval = (0.03, 0.12)
    """side of a square post in a row of posts [m]"""
    post_height: LegInterval = (0.9, 2.0)
    """height of the posts [m]"""
    room: WidthInterval = (0.2, 1.0)
    """room between two posts [m]"""
    angle: Annotated[float, Field(ge=0.0, le=45.0)] = 45.0
    """largest angle of the obstacle to the crossing [deg]"""


class GeneratorConfig(Strict):
    """An arena of tiles: initial ones (flat, obstacles) joined by transitions."""

    rows: Annotated[int, Field(ge=1, le=200)] = 5
    """number of tiles along y"""
    columns: Annotated[int, Field(ge=1, le=200)] = 5
    """number of tiles along x"""
    tile_size: Annotated[float, Field(ge=1.2, le=10.0), Follows.BODY] = 2.0
    """edge of a tile [m]"""
    inset: Annotated[float, Field(ge=0.0, le=0.02)] = 0.01
    """length by which every contact rectangle is shrunk on each side [m]"""
    transition_probability: Fraction = 0.8
    """probability that an initial tile is followed by a transition; else by another initial tile"""
    dead_end_probability: Fraction = 0.3
    """probability that a transition that cannot be continued is built anyway, and leads nowhere"""
    detour_probability: Fraction = 0.0
    """probability that a transition into an empty cell is a hole or a wall; the thesis has none"""
    limit_probability: Fraction = 0.0
    """probability that a transition into an empty cell is a ledge, a gap, a barrier or a row of
    posts, some of which are too much for the robot; the thesis has none"""
    stairs_probability: Fraction = 0.55
    """probability that a transition into an empty cell is stairs"""
    bridge_probability: Fraction = 0.30
    """probability that a transition into an empty cell is a bridge; the others are rubble"""
    bridge_only_below: LegLength = 0.15
    """height difference of two initial tiles below which a bridge joins them [m]"""
    bridge_below: LegLength = 0.25
    """height difference of two initial tiles below which a bridge or stairs join them [m]"""
    stairs_below: LegLength = 1.0
    """height difference of two initial tiles below which stairs join them, else nothing [m]"""
    cliff_above: LegLength = 0.4
    """height difference of neighbouring initial tiles above which they are a dead end [m]"""
    level_below: LegLength = 0.1
    """height difference of initial tiles in a row below which they are a flat link [m]"""
    obstacles: ObstaclesConfig = ObstaclesConfig()
    rubble: RubbleConfig = RubbleConfig()
    bridge: BridgeConfig = BridgeConfig()
    stairs: StairsConfig = StairsConfig()
    detour: DetourConfig = DetourConfig()
    limits: LimitsConfig = LimitsConfig()

    @model_validator(mode="after")
    def _odds_leave_room(self) -> "GeneratorConfig":
        if self.stairs_probability + self.bridge_probability > 1.0 + 1e-9:
            raise ValueError("stairs_probability and bridge_probability sum to more than 1")
        return self
