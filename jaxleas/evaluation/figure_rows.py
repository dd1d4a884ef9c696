"""The numbers behind the thesis's figures, counted and measured on walked guide paths."""

from dataclasses import replace

import numpy as np

from jaxleas.evaluation.exact_answers import Judged
from jaxleas.evaluation.figure_file import Course, Figures, HeightBand, StepRow
from jaxleas.evaluation.height_band import height_band
from jaxleas.evaluation.judge import CellRollOut, rounded
from jaxleas.evaluation.starts import Grounds
from jaxleas.evaluation.statistics import wilson_interval
from jaxleas.evaluation.suites import Cell
from jaxleas.terrain import HeightMap

BINS = 120


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


def with_heights(
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


def with_course(
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
