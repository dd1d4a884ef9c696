"""The basis of a report: the small suites and the scenes of its pictures, on one ground."""

from dataclasses import dataclass, replace

from jaxleas.evaluation.starts import Grounds, make_grounds
from jaxleas.evaluation.suited import suited
from jaxleas.evaluation.suites import REPORTED, STARTS_PER_SCENE, Cell, Suite, make_suite
from jaxleas.robots import Robot

LARGE = "transitions"
"""The suite with many scenes; a report only draws the first of each kind."""


@dataclass(frozen=True)
class ReportBasis:
    """Suites and pictures that share their terrain, and therefore their compiled roll-outs.

    Attributes:
        suites: suites by name, all but the large one.
        shown: cells to be drawn, each on the first scene of its kind, by suite, name and yaw.
        steps: number of steps of the roll-outs of each suite.
        grounds: height maps of all of them.
    """

    suites: dict[str, Suite]
    shown: dict[tuple[str, str, float], Cell]
    steps: dict[str, int]
    grounds: Grounds


def make_report_basis(robot: Robot, starts: int | None = None, seed: int = 0) -> ReportBasis:
    """Return the basis of a report.

    Args:
        robot: robot that is judged.
        starts: number of starts per cell; by default each suite's usual number.
        seed: seed of scenes and starts.
    """
    suites = {
        name: suited(make_suite(name, starts, seed), robot) for name in REPORTED if name != LARGE
    }
    large = suited(make_suite(LARGE, STARTS_PER_SCENE, seed), robot)
    like = suites["hole"]  # drawn with as many starts and steps as another suite is judged with
    shown = {
        (suite.name, cell.name, cell.yaw): replace(
            cell,
            scenarios=cell.scenarios[:1],
            starts=like.cells[0].starts if suite is large else cell.starts,
        )
        for suite in (large, *suites.values())
        for cell in suite.cells
    }
    cells = [*shown.values(), *(cell for suite in suites.values() for cell in suite.cells)]
    steps = {name: suite.steps for name, suite in suites.items()} | {LARGE: like.steps}
    return ReportBasis(suites, shown, steps, make_grounds(cells))
