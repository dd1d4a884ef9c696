"""Named evaluation suites: cells of scenes, starts and headings never met in training."""

import difflib
from dataclasses import dataclass, replace
from typing import Literal

from jaxleas.evaluation.recipes import RECIPES, Expectation, Recipe, Row
from jaxleas.terrain import EVALUATION_SEED, SCENARIOS, TUNING_SEED, Scale, Scenario
from jaxleas.types import InputError

STARTS_PER_SCENE = RECIPES["transitions"].starts_per_scene
"""Approximate number of starts per scene; a cell spreads its starts over many scenes."""
SCENES_PER_SEED = 10_000
"""Offset between the scenes of two seeds, which never overlap."""
MAX_SEED = 10_000
MAX_TUNING_SEED = (EVALUATION_SEED - TUNING_SEED) // SCENES_PER_SEED
MAX_STARTS = STARTS_PER_SCENE * SCENES_PER_SEED
HELD_OUT_SUFFIX = "_held_out"
SUITES = tuple(RECIPES)
SUITED_TASKS = ("steering",)
"""Tasks whose policies the suites judge."""
REPORTED = tuple(name for name, recipe in RECIPES.items() if recipe.in_report == "always")
"""Suites that every report includes; the others take longer or are requested by name."""
REPORTED_IF_EVALUATED = tuple(
    name for name, recipe in RECIPES.items() if recipe.in_report == "if evaluated"
)
"""Suites that the report of a run includes once the run was evaluated on them."""


@dataclass(frozen=True)
class Cell:
    """One number of a table: starts of one kind, and what is expected of them.

    Attributes:
        name: name of the kind of scene.
        yaw: heading at the start relative to the way ahead [deg]: 0 towards the goal, 180 with the
            back to it.
        scenarios: the scenes, with start areas (near and far, or one) and a goal area.
        starts: number of starts, spread evenly over scenes and start areas.
        expectation: "cross": reach the goal; "stop": stay valid to the end of the episode.
        yaw_spread: headings are uniform in `yaw` +- this, to either side [deg].
        speed: speed at the start, along the heading [m/s].
        aim: "crossing": the way ahead is the scenario's; "goal": from each start to its goal.
        steps: number of steps after which a roll-out is cut, where it is not the suite's.
        exactly: whether roll-outs are judged on the polygons of the scenes, too.
    """

    name: str
    yaw: float
    scenarios: tuple[Scenario, ...]
    starts: int
    expectation: Expectation = "cross"
    yaw_spread: float = 0.0
    speed: float = 0.0
    aim: Literal["crossing", "goal"] = "crossing"
    steps: int | None = None
    exactly: bool = False

    @property
    def key(self) -> tuple[str, float, float, float]:
        """Return what distinguishes a cell in its suite: name, yaw, spread, speed."""
        return self.name, self.yaw, self.yaw_spread, self.speed


@dataclass(frozen=True)
class Suite:
    """Cells that are judged together.

    Attributes:
        name: name of the suite; "..._held_out" for the terrain to tune on.
        seed: seed of the scenes and starts.
        steps: number of steps after which a roll-out is cut: long enough for all still walking.
        cells: cells of the suite.
        start_seed: seed of the starts' random stream; by default `seed`.
        scale: length in the scenes for one metre of the published ones [1].
    """

    name: str
    seed: int
    steps: int
    cells: tuple[Cell, ...]
    start_seed: int | None = None
    scale: float = 1.0

    def scaled(self, scale: Scale) -> "Suite":
        """Return the same suite with its scenes, starts and goals in the scale of a robot."""
        scenarios = {id(each): each for cell in self.cells for each in cell.scenarios}
        made = {identity: each.scaled(scale.leg) for identity, each in scenarios.items()}
        cells = tuple(
            replace(cell, scenarios=tuple(made[id(each)] for each in cell.scenarios))
            for cell in self.cells
        )
        return replace(self, cells=cells, scale=self.scale * scale.leg)

    def stream(self) -> int:
        """Return the seed used to draw the starts."""
        return self.seed if self.start_seed is None else self.start_seed

    def steps_of(self, cell: Cell) -> int:
        """Return the number of steps after which a roll-out of a cell is cut."""
        return self.steps if cell.steps is None else cell.steps


def make_suite(
    name: str, starts: int | None = None, seed: int = 0, held_out: bool = False
) -> Suite:
    """Return a suite: always the same one for the same name, starts and seed.

    Its scenes have the published sizes, which suit Talos; `Suite.scaled` suits them to a robot.

    Args:
        name: one of SUITES.
        starts: number of starts per cell; by default the suite's usual number.
        seed: shifts scenes and starts within the range of seeds kept for evaluation.
        held_out: whether to use other terrain and other starts: to choose and tune by, so that
            evaluation terrain stays unseen.

    Raises:
        InputError: no suite has that name, or a number is out of range.
    """
    if name not in RECIPES:
        close = difflib.get_close_matches(name, SUITES, n=1, cutoff=0.5)
        hint = f"did you mean {close[0]!r}? There are" if close else "there are"
        raise InputError(f"no suite is called {name!r}; {hint} {', '.join(SUITES)}")
    recipe = RECIPES[name]
    starts = recipe.starts if starts is None else starts
    most = recipe.starts_per_scene * SCENES_PER_SEED
    if not 1 <= starts <= most:
        raise InputError(f"starts = {starts}: a cell needs at least 1 and at most {most}")
    kind, last = ("held-out", MAX_TUNING_SEED) if held_out else ("evaluation", MAX_SEED)
    if not 0 <= seed < last:
        raise InputError(f"seed = {seed}: {kind} seeds go from 0 to {last - 1}")
    seeds = scene_seeds(starts, seed, recipe.starts_per_scene, held_out)
    cells = _cells(recipe, starts, seeds)
    # No evaluation seed draws the starts of a held-out suite: some scenes are the same for all.
    start_seed = MAX_SEED + seed if held_out else seed
    return Suite(
        name + HELD_OUT_SUFFIX * held_out, seed, recipe.steps, cells, start_seed=start_seed
    )


def scene_seeds(
    starts: int, seed: int, starts_per_scene: int = STARTS_PER_SCENE, held_out: bool = False
) -> range:
    """Return the terrain seeds of a cell with the given number of starts."""
    first = (TUNING_SEED if held_out else EVALUATION_SEED) + seed * SCENES_PER_SEED
    return range(first, first + -(-starts // starts_per_scene))


def _cells(recipe: Recipe, starts: int, seeds: range) -> tuple[Cell, ...]:
    # All headings on the same scenes: two cells differ in the heading alone.
    scenarios = {
        name: tuple(SCENARIOS[name](each) for each in seeds)
        for name in dict.fromkeys(row.scenario for row in recipe.rows)
    }
    return tuple(_cell(row, scenarios[row.scenario], starts, recipe) for row in recipe.rows)


def _cell(row: Row, scenarios: tuple[Scenario, ...], starts: int, recipe: Recipe) -> Cell:
    return Cell(
        row.name,
        row.yaw,
        scenarios,
        starts,
        recipe.expectation,
        row.yaw_spread,
        row.speed,
        row.aim,
        row.steps,
        recipe.exactly,
    )
