"""Measure what the thesis's figures 4.17 and 5.6 to 5.9 show, for any methods (T 4.3.3, 5.2.4)."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

from jaxleas.contacts import PlannerSettings
from jaxleas.envs.steering import SteeringEnv
from jaxleas.evaluation.contender import Contender
from jaxleas.evaluation.exact_answers import ask
from jaxleas.evaluation.figure_file import FigureFile, Figures, write_figures
from jaxleas.evaluation.figure_rows import step_row, with_course, with_heights
from jaxleas.evaluation.starts import draw_starts, make_grounds
from jaxleas.evaluation.suites import Cell, Suite
from jaxleas.labels import Judge
from jaxleas.workers import Workers

BASIC = ("stairs_up", "stairs_down", "rubble")
COURSE = "long_course"
SPEED = 0.04  # at the start: chapter 4's, one set of guides for all planners [m/s]
KEEP_EVERY = (6, 8, 10, 12, 14, 16, 18, 20)
"""Values of N from 6 to 20, as in fig. 5.6."""


@dataclass(frozen=True)
class Questions:
    """What an exact planner is asked for the figures.

    Attributes:
        settings: settings of the planner; every N replaces its `keep_every`.
        workers: workers that judge.
        keep_every: values of N.
    """

    settings: PlannerSettings
    workers: Workers
    keep_every: Sequence[int] = KEEP_EVERY


def figure_cells(suite: Suite, course_starts: int) -> dict[str, Cell]:
    """Return the cells of the suite `thesis` that figures are made of, by name.

    Args:
        suite: `thesis`, with starts for the basic scenarios.
        course_starts: number of starts on the long course, whose guide paths take much longer.
    """
    return {
        cell.name: replace(cell, starts=course_starts) if cell.name == COURSE else cell
        for cell in suite.cells
        if cell.name in (*BASIC, COURSE) and cell.speed == SPEED
    }


def measure_figures(
    env: SteeringEnv,
    contenders: Mapping[str, Contender],
    suite: Suite,
    questions: Questions,
    file: FigureFile,
    say: Callable[[str], None] = lambda text: None,
) -> Figures:
    """Fill in what a figure file lacks; it is written after each row, so that work can restart.

    Args:
        env: steering task.
        contenders: methods, by name.
        suite: `thesis`, cut down to the cells of `figure_cells`.
        questions: settings, workers and discretisations of the exact planner.
        file: figure file, with the rows that it has already.
        say: callable that is given a description of what is being done.
    """
    cells = {cell.name: cell for cell in suite.cells}
    figures, keep_every = file.figures, questions.keep_every
    grounds = make_grounds(list(cells.values()))
    known = {(row.cell, row.method, row.keep_every): row for row in figures.steps}
    total = len(cells) * len(contenders) * len(keep_every)
    for name in (*BASIC, COURSE):
        cell = cells[name]
        starts = None
        for method, roll_out in contenders.items():
            if all((name, method, each) in known for each in keep_every):
                continue
            starts = starts or draw_starts(env, grounds, cell, suite.stream())
            walked = roll_out(grounds, starts, suite.steps_of(cell))
            if name == "stairs_up":
                figures = with_heights(figures, grounds, cell, method, walked)
            for each in keep_every:
                if (name, method, each) in known:
                    continue
                say(f"figures {len(known) + 1}/{total}: {method} on {name}, 1 in {each}")
                chosen = questions.settings.model_copy(update={"keep_every": each})
                robot = env.config.robot
                judge = Judge(figures.planner, chosen, workers=questions.workers, robot=robot)
                judged = ask(cell, walked, judge, env.config.limits.time_step)
                row = step_row(cell, method, each, judged)
                known[name, method, each] = row
                figures = figures.model_copy(update={"steps": tuple(known.values())})
                if name == COURSE and each == questions.settings.keep_every:
                    figures = with_course(figures, grounds, cell, method, judged, each)
                write_figures(file.path, figures)
    return figures
