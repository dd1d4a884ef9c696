"""Named suites of judgement: cells of scenes, starts and headings, never met in training."""

import difflib
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

from jaxleas.terrain.scenarios import Scenario, circuit, dead_end, hole, transition, wall
from jaxleas.terrain.seeds import EVALUATION_SEED
from jaxleas.types.errors import InputError

Expectation = Literal["cross", "stop"]
STARTS_PER_SCENE = 20
"""A cell spreads its starts over many different scenes, about so many on each."""
SCENES_PER_SEED = 10_000
"""Scenes of two evaluation seeds never overlap."""
MAX_SEED = 10_000
MAX_STARTS = STARTS_PER_SCENE * SCENES_PER_SEED


@dataclass(frozen=True)
class Cell:
    """One number of a table: starts of one kind, and what is expected of them.

    Attributes:
        name: of the kind of scene.
        yaw: heading at the start relative to the direction of crossing [deg]: 0 towards the
            goal, 180 with the back to it.
        scenarios: the scenes, with start areas (near and far, or one) and a goal area.
        starts: spread evenly over scenes and start areas.
        expectation: "cross": reach the goal; "stop": stay valid to the end of the episode.
    """

    name: str
    yaw: float
    scenarios: tuple[Scenario, ...]
    starts: int
    expectation: Expectation = "cross"


@dataclass(frozen=True)
class Suite:
    """Cells that are judged together.

    Attributes:
        name: of the suite.
        seed: which of the evaluation scenes and starts.
        steps: after which a roll-out is cut: long enough for all who still walk.
        cells: of the suite.
    """

    name: str
    seed: int
    steps: int
    cells: tuple[Cell, ...]


@dataclass(frozen=True)
class _Recipe:
    """How to make a suite: its scenes by cell name, headings [deg], usual starts, steps."""

    scenes: dict[str, Callable[[int], Scenario]]
    yaws: tuple[float, ...]
    starts: int
    steps: int
    expectation: Expectation = "cross"


_RECIPES = {
    # T table 3.3; 600 steps walk 12 m at the desired speed, twice the longest crossing.
    "transitions": _Recipe(
        {
            "rubble": lambda seed: transition("rubble", seed),
            "bridge": lambda seed: transition("bridge", seed),
            "stairs_down": lambda seed: transition("stairs_down", seed),
            "stairs_up": lambda seed: transition("stairs_up", seed),
        },
        yaws=(0.0, 180.0),
        starts=1000,
        steps=600,
    ),
    "hole": _Recipe({"hole": hole}, yaws=(0.0,), starts=200, steps=800),
    "wall": _Recipe({"wall": wall}, yaws=(0.0,), starts=200, steps=800),
    "circuit": _Recipe({"circuit": circuit}, yaws=(0.0,), starts=100, steps=3000),
    # As long as the thesis's episodes: standing at the edge is easy for a moment only.
    "dead_end": _Recipe(
        {
            "void": lambda seed: dead_end("void", seed),
            "wall": lambda seed: dead_end("wall", seed),
            "platform": lambda seed: dead_end("platform", seed),
        },
        yaws=(0.0, 180.0),
        starts=200,
        steps=800,
        expectation="stop",
    ),
}

SUITES = tuple(_RECIPES)


def make_suite(name: str, starts: int | None = None, seed: int = 0) -> Suite:
    """Return a suite: the same one, always, for the same name, starts and seed.

    Args:
        name: one of SUITES.
        starts: a cell; by default what the suite usually has.
        seed: shifts scenes and starts within the range of seeds kept for evaluation.

    Raises:
        InputError: no suite has that name, or a number is out of range.
    """
    if name not in _RECIPES:
        close = difflib.get_close_matches(name, SUITES, n=1, cutoff=0.5)
        hint = f"did you mean {close[0]!r}? There are" if close else "there are"
        raise InputError(f"no suite is called {name!r}; {hint} {', '.join(SUITES)}")
    recipe = _RECIPES[name]
    starts = recipe.starts if starts is None else starts
    if not 1 <= starts <= MAX_STARTS:
        raise InputError(f"starts = {starts}: a cell needs at least 1 and at most {MAX_STARTS}")
    if not 0 <= seed < MAX_SEED:
        raise InputError(f"seed = {seed}: evaluation seeds go from 0 to {MAX_SEED - 1}")
    cells = []
    for cell_name, make_scene in recipe.scenes.items():
        scenarios = tuple(make_scene(each) for each in scene_seeds(starts, seed))
        # All headings on the same scenes: what differs between two cells is the heading alone.
        cells += [
            Cell(cell_name, yaw, scenarios, starts, recipe.expectation) for yaw in recipe.yaws
        ]
    return Suite(name, seed, recipe.steps, tuple(cells))


def scene_seeds(starts: int, seed: int) -> range:
    """Return the terrain seeds of a cell with so many starts."""
    first = EVALUATION_SEED + seed * SCENES_PER_SEED
    return range(first, first + -(-starts // STARTS_PER_SCENE))
