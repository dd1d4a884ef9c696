"""The thesis's figures 4.17 and 5.6 to 5.9, drawn from a figure file."""

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from jaxleas.contacts import title_of
from jaxleas.evaluation import (
    BASIC,
    COURSE,
    Figures,
    StepRow,
    cell_title,
    method_colour,
    method_title,
)
from jaxleas.reports.picture import Picture, blank_picture, dress, png_of
from jaxleas.reports.published import thesis

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

DPI = 110


def draw_figures(figures: Figures) -> list[Picture]:
    """Draw what the file holds numbers for; the captions state the number of guide paths."""
    pictures = []
    if figures.heights:
        pictures.append(_picture("4.17", _heights(figures), _heights_words(figures)))
    basic = [row for row in figures.steps if row.cell in BASIC]
    course = [row for row in figures.steps if row.cell == COURSE]
    kept = figures.settings["keep_every"]
    planner = title_of(figures.planner)
    dots = f"Large dots: one configuration in {kept}, as trained for."
    seed = f"{'held-out' if figures.held_out else 'evaluation'} seed {figures.seed}"
    if basic:
        words = f"{basic[0].starts} starts a scenario, {planner} planner, {seed}. {dots}"
        pictures.append(
            _picture("5.6", _by_scenario(basic, kept, _success), f"Success by mean step: {words}")
        )
        picture = _by_scenario(basic, kept, _time)
        pictures.append(_picture("5.7", picture, f"Planning time by number of steps: {words}"))
    if figures.courses:
        words = f"Steps along the long course, one guide path a method, 1 in {kept}, {seed}."
        pictures.append(_picture("5.8", _course(figures), words))
    if course:
        words = f"The long course: {course[0].starts} starts, {planner} planner, {seed}. {dots}"
        pictures.append(_picture("5.9", _both(course, kept), words))
    return pictures


def _heights(figures: Figures) -> "Figure":
    figure = blank_picture(8.4, 3.8)
    ax: Axes = figure.subplots()
    along = np.array(figures.along)
    ground = np.array(figures.ground, float)
    floor = float(np.nanmin(ground)) - 0.2
    ax.fill_between(along, floor, np.nan_to_num(ground, nan=floor), color="0.6", label="ground")
    for band in figures.heights:
        colour, title = (
            method_colour(band.method),
            f"{method_title(band.method)} ({band.guides} paths)",
        )
        low, mean, high = (np.array(each, float) for each in (band.low, band.mean, band.high))
        ax.plot(along, mean, color=colour, label=title)
        ax.fill_between(along, low, high, color=colour, alpha=0.15, linewidth=0)
    _dress(ax, "x [m]", "height [m]")
    ax.set_ylim(bottom=floor)
    ax.legend(fontsize=8, frameon=False)
    return figure


def _heights_words(figures: Figures) -> str:
    gaps = ", ".join(
        f"{method_title(band.method)} {band.clearance:.2f} m"
        for band in figures.heights
        if band.clearance is not None
    )
    return (
        "Root height over stairs up, guide paths of one scene that reached the goal: mean, lowest"
        f" and highest. Mean distance from the ground: {gaps}."
    )


def _by_scenario(rows: Sequence[StepRow], kept: int, draw: Callable[..., None]) -> "Figure":
    figure = blank_picture(10.4, 3.5)
    for ax, name in zip(figure.subplots(1, len(BASIC)), BASIC, strict=True):
        draw(ax, [row for row in rows if row.cell == name], kept)
        ax.set_title(cell_title(name), loc="left", fontsize=10)
    _legend(figure)
    return figure


def _both(rows: Sequence[StepRow], kept: int) -> "Figure":
    figure = blank_picture(8.4, 3.5)
    left, right = figure.subplots(1, 2)
    _success(left, rows, kept)
    _time(right, rows, kept)
    _legend(figure)
    return figure


def _success(ax: "Axes", rows: Sequence[StepRow], kept: int) -> None:
    for method, mine in _by_method(rows).items():
        there = [row for row in mine if row.mean_step is not None]
        x = [100.0 * (row.mean_step or 0.0) for row in there]
        y = [100.0 * row.planned for row in there]
        _line(ax, method, x, y, [row.keep_every == kept for row in there])
    _dress(ax, "mean step of the root [cm]", "success of all starts [%]")
    ax.set_ylim(-3.0, 103.0)


def _time(ax: "Axes", rows: Sequence[StepRow], kept: int) -> None:
    for method, mine in _by_method(rows).items():
        there = [row for row in mine if row.seconds is not None]
        x = [row.steps or 0.0 for row in there]
        y = [1000.0 * (row.seconds or 0.0) for row in there]
        _line(ax, method, x, y, [row.keep_every == kept for row in there])
    _dress(ax, "steps", "planning, mean of successes [ms]")
    ax.set_ylim(bottom=0.0)


def _line(ax: "Axes", method: str, x: list[float], y: list[float], marked: list[bool]) -> None:
    colour = method_colour(method)
    ax.plot(x, y, color=colour, marker=".", linewidth=1.2, label=method_title(method))
    dots = [(a, b) for a, b, flag in zip(x, y, marked, strict=True) if flag]
    if dots:
        ax.scatter(*zip(*dots, strict=True), s=60, color=colour, zorder=3)


def _course(figures: Figures) -> "Figure":
    figure = blank_picture(10.4, 4.4)
    top, bottom = figure.subplots(2, 1, sharex=True, height_ratios=(1, 2))
    along, ground = np.array(figures.course_along), np.array(figures.course_ground, float)
    floor = float(np.nanmin(ground)) - 0.1
    top.fill_between(along, floor, np.nan_to_num(ground, nan=floor), color="0.6")
    _dress(top, "", "ground [m]")
    for course in figures.courses:
        ending = "planned" if course.planned else "not planned" if course.reached else "not reached"
        title = f"{method_title(course.method)}, {ending}"
        step = 100.0 * np.array(course.step)
        bottom.plot(
            course.x, step, ".-", color=method_colour(course.method), linewidth=1, label=title
        )
    _dress(bottom, "x [m]", "step of the root [cm]")
    bottom.set_ylim(bottom=0.0)
    bottom.legend(fontsize=8, frameon=False)
    return figure


def _by_method(rows: Sequence[StepRow]) -> dict[str, list[StepRow]]:
    ordered = sorted(rows, key=lambda row: row.keep_every)
    return {
        method: [row for row in ordered if row.method == method]
        for method in dict.fromkeys(row.method for row in rows)
    }


def _dress(ax: "Axes", x: str, y: str) -> None:
    ax.set(xlabel=x, ylabel=y)
    dress(ax)


def _legend(figure: "Figure") -> None:
    handles, labels = figure.axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=4, frameon=False, fontsize=8)


def _picture(number: str, figure: "Figure", words: str) -> Picture:
    caption = f"{words} The thesis, figure {number}: {thesis().figures[number]}"
    return Picture(f"figure {number}", caption, png_of(figure, DPI))
