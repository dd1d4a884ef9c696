"""Measure what the thesis's figures 4.17 and 5.6 to 5.9 show, for any methods (T 4.3.3, 5.2.4)."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from jaxleas.contacts import PlannerSettings
from jaxleas.envs.steering import SteeringEnv
from jaxleas.evaluation.contender import Contender
from jaxleas.evaluation.exact_answers import Judged, ask
from jaxleas.evaluation.figure_file import (
    Course,
    FigureFile,
    Figures,
    HeightBand,
    StepRow,
    write_figures,
)
from jaxleas.evaluation.height_band import height_band
from jaxleas.evaluation.judge import CellRollOut, rounded
from jaxleas.evaluation.starts import Grounds, draw_starts, make_grounds
from jaxleas.evaluation.statistics import wilson_interval
from jaxleas.evaluation.suites import Cell, Suite
from jaxleas.labels import Judge
from jaxleas.terrain import HeightMap
from jaxleas.workers import Workers

BASIC = ("stairs_up", "stairs_down", "rubble")
COURSE = "long_course"
SPEED = 0.04  # at the start: chapter 4's, one set of guides for all planners [m/s]
KEEP_EVERY = (6, 8, 10, 12, 14, 16, 18, 20)
"""Values of N from 6 to 20, as in fig. 5.6."""
BINS = 120


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
                figures = _with_heights(figures, grounds, cell, method, walked)
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
                    figures = _with_course(figures, grounds, cell, method, judged, each)
                write_figures(file.path, figures)
    return figures


def step_row(cell: Cell, method: str, keep_every: int, judged: Judged) -> StepRow:
    """Count and measure the guide paths of one method, for one N."""
    walked = judged.roll_outs
    paths = [walked.path(int(row)) for row in np.flatnonzero(walked.reached)]
    steps = [step_lengths(path, keep_every) for path in paths]
    good = [each for each in judged.verdicts if each is not None and each.success]
    late = [each for each in judged.verdicts if each is not None and not each.decided]
    low, high = wilson_interval(len(good), cell.starts)
    every = np.concatenate(steps) if steps else np.zeros(0)
    return StepRow(
        cell=cell.name,
        method=method,
        keep_every=keep_every,
        starts=cell.starts,
        reached=rounded(walked.reached.mean()),
        planned=rounded(len(good) / cell.starts),
        low=rounded(low),
        high=rounded(high),
        undecided=rounded(len(late) / cell.starts),
        mean_step=rounded(every.mean()) if len(every) else None,
        steps=rounded(np.mean([len(each) for each in steps])) if steps else None,
        seconds=rounded(np.mean([each.seconds for each in good])) if good else None,
        slowest=rounded(max(each.seconds for each in good)) if good else None,
    )


def step_lengths(path: np.ndarray, keep_every: int) -> np.ndarray:
    """Return the root's straight-line distances between consecutive kept configurations [m].

    Args:
        path: root positions [T, 3].
        keep_every: interval between kept configurations; the first configuration is kept.
    """
    kept = path[::keep_every].astype(np.float64)
    return np.linalg.norm(np.diff(kept, axis=0), axis=1)


def _with_heights(
    figures: Figures, grounds: Grounds, cell: Cell, method: str, walked: CellRollOut
) -> Figures:
    """Return figures with the root heights over the first scene's stairs (fig. 4.17)."""
    scene = walked.starts.scene == 0
    ground, area = _ground(grounds, cell), cell.scenarios[0].goal_area
    along = np.linspace(0.0, 0.5 * (area[0] + area[1]), BINS)
    here = replace(walked, reached=walked.reached & scene)
    low, mean, high = height_band(Judged(here, (None,) * len(scene)), along)
    gaps = [_clearance(ground, walked.path(int(row))) for row in np.flatnonzero(here.reached)]
    band = HeightBand(
        method=method,
        guides=int(here.reached.sum()),
        low=_plain(low),
        mean=_plain(mean),
        high=_plain(high),
        clearance=rounded(np.mean(gaps)) if gaps else None,
    )
    others = tuple(each for each in figures.heights if each.method != method)
    height = ground.height_at(np.column_stack([along, np.zeros(BINS)]))
    return figures.model_copy(
        update={"along": _plain(along), "ground": _plain(height), "heights": (*others, band)}
    )


def _with_course(
    figures: Figures, grounds: Grounds, cell: Cell, method: str, judged: Judged, keep_every: int
) -> Figures:
    """Return figures with one guide path along the long course (fig. 5.8)."""
    walked = judged.roll_outs
    scene = walked.starts.scene == 0
    best = next(
        (flag for flag in (judged.planned & scene, walked.reached & scene) if flag.any()), scene
    )
    row = int(np.argmax(best))
    path = walked.path(row)
    course = Course(
        method=method,
        reached=bool(walked.reached[row]),
        planned=bool(judged.planned[row]),
        x=tuple(path[::keep_every][:-1, 0].astype(np.float64).round(4).tolist()),
        step=tuple(step_lengths(path, keep_every).round(4).tolist()),
    )
    ground = _ground(grounds, cell)
    x_min, x_max, _, _ = ground.extent
    along = np.linspace(x_min, x_max, 4 * BINS)
    height = ground.height_at(np.column_stack([along, np.zeros(len(along))]))
    others = tuple(each for each in figures.courses if each.method != method)
    return figures.model_copy(
        update={
            "course_along": _plain(along),
            "course_ground": _plain(height),
            "courses": (*others, course),
        }
    )


def _ground(grounds: Grounds, cell: Cell) -> HeightMap:
    return grounds.maps[grounds.index[id(cell.scenarios[0])]]


def _clearance(ground: HeightMap, path: np.ndarray) -> float:
    return float(np.nanmean(path[:, 2] - ground.height_at(path[:, :2].astype(np.float64))))


def _plain(values: np.ndarray) -> tuple[float | None, ...]:
    return tuple(round(float(each), 4) if np.isfinite(each) else None for each in values)
