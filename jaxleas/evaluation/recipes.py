"""The contents of each suite: which named scenarios, from which headings, at which speed."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Literal

from jaxleas.terrain import LIMITS

Expectation = Literal["cross", "stop"]


@dataclass(frozen=True)
class Row:
    """One cell of a suite.

    Attributes:
        name: name of the cell.
        scenario: name of the scenario in `terrain.SCENARIOS`.
        yaw: heading at the start relative to the way ahead [deg].
        yaw_spread: headings are uniform in `yaw` +- this, to either side [deg].
        speed: speed at the start, along the heading [m/s].
        aim: "crossing": the way ahead is the scenario's direction, the same for all starts; "goal":
            it is each start's own direction to its goal.
        steps: number of steps after which a roll-out is cut; by default the suite's.
    """

    name: str
    scenario: str
    yaw: float = 0.0
    yaw_spread: float = 0.0
    speed: float = 0.0
    aim: Literal["crossing", "goal"] = "crossing"
    steps: int | None = None


@dataclass(frozen=True)
class Recipe:
    """How to make a suite.

    Attributes:
        rows: cells of the suite.
        starts: usual number of starts per cell.
        steps: number of steps after which a roll-out is cut: long enough for all still walking.
        expectation: expectation of all its cells.
        starts_per_scene: approximate number of starts that share a scene.
        in_report: whether a run's report includes the suite: always, if the run was evaluated on
            it, or never.
        exactly: whether roll-outs are judged on the polygons of the scenes, too: the points of the
            height map at which a policy is judged lie too far apart for a thin wall.
    """

    rows: tuple[Row, ...]
    starts: int
    steps: int
    expectation: Expectation = "cross"
    starts_per_scene: int = 20
    in_report: Literal["always", "if evaluated", "never"] = "always"
    exactly: bool = False


def _rows(names: Iterable[str], yaws: Iterable[float], prefix: str = "") -> tuple[Row, ...]:
    return tuple(Row(name, prefix + name, yaw) for name in names for yaw in yaws)


KINDS = ("rubble", "bridge", "stairs_down", "stairs_up")
BOTH = (0.0, 180.0)
ROTATION = Row("rotation", "rotation", aim="goal")
CROSSING = Row("", "", speed=0.04, aim="goal")
"""Starts as at the beginning of chapter 4: facing the goal, at 0.04 m/s."""


def _crossing(name: str) -> Row:
    return replace(CROSSING, name=name, scenario=name)


THESIS = (
    # T table 4.1: the angle between heading and goal in three ranges, three speeds.
    *(
        replace(ROTATION, yaw=yaw, yaw_spread=spread, speed=speed)
        for yaw, spread in ((15.0, 15.0), (90.0, 30.0), (165.0, 15.0))
        for speed in (0.0, 0.04, 0.07)
    ),
    # T fig. 3.15 and table 4.2: at rest over the whole width; walking next to the void.
    Row("hole", "hole", aim="goal"),
    _crossing("hole_rim"),
    _crossing("bridge"),
    _crossing("bridge_ahead"),
    # T 4.3.2 (B2), table 4.3, figs. 3.14 and 5.6.
    _crossing("wall"),
    _crossing("rubble"),
    Row("stairs_up", "stairs_up", yaw=90.0),
    _crossing("stairs_up"),
    _crossing("stairs_down"),
    # T figs. 5.8 and 3.17: 22 and 24 m, 1100 and 1200 steps at the desired speed.
    replace(_crossing("long_course"), steps=3000),
    Row("circuit", "circuit", steps=3000),
)

FOOTSTEPS = tuple(
    row
    for row in THESIS
    if row.scenario in ("stairs_up", "stairs_down", "rubble", "long_course") and row.yaw == 0.0
)
"""T figs. 5.6 and 5.8: what the planners of chapter 5 were asked about."""

TABLES = tuple(
    row
    for row in THESIS
    if row.aim == "goal"
    and row.scenario in ("rotation", "hole_rim", "bridge_ahead", "wall", "rubble", "stairs_up")
)
"""T tables 4.1 to 4.3 and 4.3.2 (B2): what the sampling-based planner was asked about."""

RECIPES: Mapping[str, Recipe] = MappingProxyType(
    {
        # T table 3.3; 600 steps walk 12 m at the desired speed, twice the longest crossing.
        "transitions": Recipe(_rows(KINDS, BOTH), starts=1000, steps=600),
        "hole": Recipe(_rows(("hole",), (0.0,)), starts=200, steps=800),
        "wall": Recipe(_rows(("wall",), (0.0,)), starts=200, steps=800),
        "circuit": Recipe(_rows(("circuit",), (0.0,)), starts=100, steps=3000),
        # As long as the thesis's episodes: standing at the edge is easy for a moment only.
        "dead_end": Recipe(
            _rows(("void", "wall", "platform"), BOTH, prefix="dead_end_"),
            starts=200,
            steps=800,
            expectation="stop",
        ),
        # What just can and just cannot be crossed: the cells are parted for the robot.
        "limits": Recipe(
            _rows(LIMITS, (0.0,)),
            starts=200,
            steps=800,
            starts_per_scene=10,
            in_report="if evaluated",
            exactly=True,
        ),
        # T fig. 3.16: the transitions in one terrain, whose ground goes on behind each goal.
        "evaluation_terrain": Recipe(
            _rows(KINDS, BOTH, prefix="evaluation_terrain_"),
            starts=200,
            steps=800,
            in_report="never",
        ),
        "footsteps": Recipe(
            FOOTSTEPS, starts=200, steps=800, starts_per_scene=10, in_report="never"
        ),
        "tables": Recipe(TABLES, starts=200, steps=800, starts_per_scene=10, in_report="never"),
        "thesis": Recipe(THESIS, starts=100, steps=800, starts_per_scene=10, in_report="never"),
    }
)
