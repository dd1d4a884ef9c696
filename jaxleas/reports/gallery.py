"""The pictures of a report: one scene of every kind, many starts, a few paths."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from jaxleas.envs.steering import SteeringEnv
from jaxleas.evaluation import (
    Cell,
    CellRollOut,
    Grounds,
    ReportBasis,
    cell_title,
    draw_starts,
    method_title,
    roll_out_cell,
)
from jaxleas.guide import SteeringMethod
from jaxleas.reports.height_profile import draw_profile
from jaxleas.reports.picture import Picture, blank_picture, png_of
from jaxleas.reports.top_view import View, choose_examples, draw_view, legend

if TYPE_CHECKING:
    from matplotlib.figure import Figure

DOTS = 80
"""Number of starts drawn in a picture, as in T fig. 3.14."""
DPI = 120


@dataclass(frozen=True)
class _Shown:
    """One cell, as walked by every method."""

    cell: Cell
    roll_outs: dict[str, CellRollOut]


def draw_gallery(
    env: SteeringEnv, methods: Mapping[str, SteeringMethod], basis: ReportBasis
) -> list[Picture]:
    """Walk one scene of every kind and draw it.

    Args:
        env: steering task.
        methods: steering methods; the first is the report's, and a second is drawn next to it.
        basis: basis with the cells to be drawn.
    """
    grounds = basis.grounds
    first = next(iter(methods))

    def show(suite: str, name: str, yaw: float, beside: bool = True) -> _Shown:
        cell = basis.shown[suite, name, yaw]
        starts = draw_starts(env, grounds, cell, seed=0)
        roll_outs = {
            title: roll_out_cell(env, grounds, method, starts, basis.steps[suite])
            for title, method in methods.items()
            if beside or title == first
        }
        return _Shown(cell, roll_outs)

    kinds = ("rubble", "bridge", "stairs_down", "stairs_up")
    transitions = [show("transitions", name, 180.0) for name in kinds]
    detours = [show("hole", "hole", 0.0), show("wall", "wall", 0.0)]
    ends = [show("dead_end", name, 0.0, beside=False) for name in ("void", "wall", "platform")]
    rounds = show("circuit", "circuit", 0.0, beside=False)
    return [
        _picture(
            "transitions",
            f"The four transitions, {DOTS} starts each, with the back to the goal: yellow dots"
            " reached it, black ones met an invalid configuration, white ones stopped. Blue:"
            " example paths, with headings in black.",
            _side_by_side(env, grounds, transitions, list(methods), (5.6, 2.15), examples=3),
        ),
        _picture(
            "profile",
            "Height profiles on stairs: the root rises and sinks ahead of the steps, so that the"
            " ground stays within reach of the legs and below the trunk.",
            _profiles(env, grounds, transitions[2:], first),
        ),
        _picture(
            "detours",
            "A hole and a wall between starts and goal.",
            _side_by_side(env, grounds, detours, list(methods), (4.6, 3.9), examples=6),
        ),
        _picture(
            "circuit",
            "A circuit over stairs, bridges and rubble: waypoints in order, the last one at the"
            " start.",
            _single(env, grounds, rounds, first),
        ),
        _picture(
            "dead_ends",
            "Dead ends: nothing, a wall, a platform too high. White dots stopped in time and stayed"
            " valid to the end of the episode.",
            _ends(env, grounds, ends, first),
        ),
    ]


def _view(
    env: SteeringEnv, grounds: Grounds, shown: _Shown, method: str, examples: int, title: str
) -> View:
    walked = shown.roll_outs[method]
    ground = grounds.maps[grounds.index[id(shown.cell.scenarios[0])]]
    chosen = choose_examples(walked, examples, DOTS)
    return View(title, ground, walked, chosen, DOTS, env.config.goal_radius)


def _title(shown: _Shown, method: str) -> str:
    reached = shown.roll_outs[method].reached[:DOTS]
    done = f"{int(reached.sum())} of {len(reached)} reached"
    return f"{method_title(method)}, {cell_title(shown.cell.name)}: {done}"


def _side_by_side(
    env: SteeringEnv,
    grounds: Grounds,
    shown: list[_Shown],
    methods: list[str],
    size: tuple[float, float],
    examples: int,
) -> "Figure":
    """Draw a row for each cell and a column for each method, views of this size [inches]."""
    figure = blank_picture(size[0] * len(methods), size[1] * len(shown) + 0.5)
    axes = figure.subplots(len(shown), len(methods), squeeze=False)
    for row, each in zip(axes, shown, strict=True):
        for ax, method in zip(row, methods, strict=True):
            draw_view(ax, _view(env, grounds, each, method, examples, _title(each, method)))
    legend(figure)
    return figure


def _ends(env: SteeringEnv, grounds: Grounds, shown: list[_Shown], method: str) -> "Figure":
    figure = blank_picture(3.9 * len(shown), 2.75)
    axes = figure.subplots(1, len(shown), squeeze=False)[0]
    for ax, each in zip(axes, shown, strict=True):
        valid = ~each.roll_outs[method].invalid[:DOTS]
        title = f"{cell_title(each.cell.name)}: {int(valid.sum())} of {len(valid)} stayed valid"
        draw_view(ax, _view(env, grounds, each, method, 2, title))
    widest = max(ax.get_xlim()[1] for ax in axes)
    for ax in axes:
        ax.set_xlim(right=widest)  # one scale for all
    legend(figure)
    return figure


def _single(env: SteeringEnv, grounds: Grounds, shown: _Shown, method: str) -> "Figure":
    figure = blank_picture(9.0, 6.0)
    draw_view(figure.subplots(), _view(env, grounds, shown, method, 1, _title(shown, method)))
    legend(figure)
    return figure


def _profiles(env: SteeringEnv, grounds: Grounds, shown: list[_Shown], method: str) -> "Figure":
    figure = blank_picture(5.6 * len(shown), 3.6)
    axes = figure.subplots(1, len(shown), squeeze=False)[0]
    for ax, each in zip(axes, shown, strict=True):
        walked = each.roll_outs[method]
        far = np.where(walked.reached, -walked.position[:, 0, 0], -np.inf)
        index = int(np.argmax(far))  # of those that arrived, the one that started farthest
        ground = grounds.maps[grounds.index[id(each.cell.scenarios[0])]]
        title = f"{method_title(method)}, {cell_title(each.cell.name)}"
        draw_profile(ax, env.robot, ground, walked, index, title)
    handles, labels = axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=4, frameon=False, fontsize=8)
    return figure


def _picture(name: str, caption: str, figure: "Figure") -> Picture:
    return Picture(name, caption, png_of(figure, DPI))
