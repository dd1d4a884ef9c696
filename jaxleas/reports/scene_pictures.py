"""Pictures of a comparison: guide paths over each scene, and root heights over stairs."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from jaxleas.envs.steering import SteeringEnv
from jaxleas.evaluation import (
    Cell,
    Contender,
    Grounds,
    Judged,
    Suite,
    ask,
    cell_title,
    draw_starts,
    height_band,
    make_grounds,
    method_title,
)
from jaxleas.files import write_bytes
from jaxleas.labels import Judge
from jaxleas.reports.picture import blank_picture, png_of
from jaxleas.reports.top_view import View, choose_examples, draw_view, legend

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

STARTS = 40
"""Number of starts in each picture, all on the cell's first scene."""
EXAMPLES = 6
"""Number of guide paths drawn."""
HEIGHT_CELL, BINS = "stairs_up", 120
COLOURS = ("#1f5fd0", "#2e9e4f", "#d07c1f", "#8a3fb5", "#7a7a7a")
DPI = 100


def draw_side_by_side(
    env: SteeringEnv,
    contenders: Mapping[str, Contender],
    suite: Suite,
    planners: tuple[str, ...],
    folder: Path,
    say: Callable[[str], None] = lambda text: None,
) -> list[Path]:
    """Draw every cell of a suite, one method next to the other, and the root over stairs.

    Args:
        env: steering task.
        contenders: contenders by method name.
        suite: suite whose cells are drawn.
        planners: names of the exact planners; the first colours the starts.
        folder: folder of the pictures.
        say: callable that is given a description of what is being drawn.

    Returns:
        Paths of the pictures.
    """
    shown = [replace(cell, scenarios=cell.scenarios[:1], starts=STARTS) for cell in suite.cells]
    grounds = make_grounds(shown)
    files = []
    for cell in shown:
        say(f"drawing {cell_title(cell.name)} at {cell.yaw:.0f} deg")
        starts = draw_starts(env, grounds, cell, suite.stream())
        judged = {}
        for name, roll_out in contenders.items():
            walked = roll_out(grounds, starts, suite.steps_of(cell))
            judged[name] = Judged(walked, (None,) * STARTS)
            if planners:
                judge = Judge(planners[0], robot=env.config.robot)
                judged[name] = ask(cell, walked, judge, env.config.limits.time_step)
        planner = planners[0] if planners else None
        figure = _scene(env, grounds, cell, judged, planner)
        files.append(_write(figure, folder / f"{_stem(cell)}.png"))
        if cell.name == HEIGHT_CELL and cell.yaw == 0.0:
            figure = _root_heights(grounds, cell, judged)
            files.append(_write(figure, folder / "root_height.png"))
    return files


def _scene(
    env: SteeringEnv,
    grounds: Grounds,
    cell: Cell,
    judged: Mapping[str, Judged],
    planner: str | None,
) -> "Figure":
    ground = grounds.maps[grounds.index[id(cell.scenarios[0])]]
    rows, columns = ground.shape
    wide = columns > 3 * rows
    count = len(judged)
    size = (11.0, 1.6 * count + 0.6) if wide else (4.2 * count, 1.0 + 4.2 * rows / columns)
    figure = blank_picture(*size)
    axes = figure.subplots(count if wide else 1, 1 if wide else count, squeeze=False).ravel()
    for ax, (name, each) in zip(axes, judged.items(), strict=True):
        reached = int(each.roll_outs.reached.sum())
        title = f"{method_title(name)}: {reached} of {STARTS} reached"
        planned = each.planned if planner is not None else None
        if planned is not None:
            title += f", {int(planned.sum())} planned"
        examples = choose_examples(each.roll_outs, EXAMPLES, STARTS)
        radius = env.config.goal_radius
        draw_view(ax, View(title, ground, each.roll_outs, examples, STARTS, radius, planned))
    figure.suptitle(f"{cell_title(cell.name)}, {_heading(cell)}", fontsize=11)
    legend(figure, planner)
    return figure


def _root_heights(grounds: Grounds, cell: Cell, judged: Mapping[str, Judged]) -> "Figure":
    """Return the mean root height over the stairs by method (T fig. 4.17)."""
    ground = grounds.maps[grounds.index[id(cell.scenarios[0])]]
    area = cell.scenarios[0].goal_area
    along = np.linspace(0.0, 0.5 * (area[0] + area[1]), BINS)
    figure = blank_picture(8.0, 4.2)
    ax: Axes = figure.subplots()
    height = ground.height_at(np.column_stack([along, np.zeros(BINS)])).astype(np.float64)
    ax.fill_between(along, -0.2, np.nan_to_num(height, nan=-0.2), color="0.6", label="ground")
    for index, (name, each) in enumerate(judged.items()):
        low, middle, high = height_band(each, along)
        colour = COLOURS[index % len(COLOURS)]
        ax.plot(along, middle, color=colour, label=f"{method_title(name)}, mean of the root")
        ax.fill_between(along, low, high, color=colour, alpha=0.15, linewidth=0)
    ax.set(xlabel="x [m]", ylabel="height [m]", ylim=(-0.2, None))
    ax.set_title("Root height over stairs, guide paths that reached the goal (mean, spread)")
    ax.grid(color="0.9", linewidth=0.5)
    ax.legend(fontsize=8, frameon=False)
    return figure


def _heading(cell: Cell) -> str:
    spread = f" ± {cell.yaw_spread:.0f}" if cell.yaw_spread else ""
    return f"{cell.yaw:.0f}{spread}°, {cell.speed:.2f} m/s"


def _stem(cell: Cell) -> str:
    return f"{cell.name}_{cell.yaw:.0f}deg_{round(100 * cell.speed)}cms"


def _write(figure: "Figure", path: Path) -> Path:
    write_bytes(path, png_of(figure, DPI))
    return path
