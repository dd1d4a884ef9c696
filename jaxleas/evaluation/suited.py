"""A suite for one robot: scenes in its size, limits parted by whether it can cross them."""

from dataclasses import replace

from jaxleas.evaluation.crossability import Crossability, crossability
from jaxleas.evaluation.suites import Cell, Suite
from jaxleas.robots import Robot
from jaxleas.terrain import Scenario, scale_for

_ANSWERS: tuple[Crossability, ...] = ("crossable", "between", "hopeless")


def suited(suite: Suite, robot: Robot) -> Suite:
    """Return a suite for a robot.

    Its scenes, starts and goals have the robot's size. A cell of limits becomes up to three:
    "..._crossable", whose goals must be reached, "..._between" and "..._hopeless", where only
    validity counts; each has as many starts, over the scenes of its kind.

    Args:
        suite: suite in published sizes.
        robot: robot that is judged.
    """
    sized = suite.scaled(scale_for(robot))
    return replace(sized, cells=tuple(part for cell in sized.cells for part in _parts(cell, robot)))


def _parts(cell: Cell, robot: Robot) -> list[Cell]:
    """Return the cells of each answer that occurs; the cell itself if it holds no limits."""
    if any(each.limit is None for each in cell.scenarios):
        return [cell]
    answers = [_answer(each, robot) for each in cell.scenarios]
    return [
        replace(
            cell,
            name=f"{cell.name}_{answer}",
            scenarios=tuple(
                scenario
                for scenario, each in zip(cell.scenarios, answers, strict=True)
                if each == answer
            ),
            expectation="cross" if answer == "crossable" else "stop",
        )
        for answer in _ANSWERS
        if answer in answers
    ]


def _answer(scenario: Scenario, robot: Robot) -> Crossability:
    assert scenario.limit is not None  # asked of limits only
    return crossability(robot, scenario.limit)
