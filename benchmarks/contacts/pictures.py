"""The thesis's table 5.1 and figures 4.5 and 5.10 to 5.13, drawn from our measurements."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from benchmarks.contacts.course import LENGTHS, THESIS_WITH, THESIS_WITHOUT
from benchmarks.contacts.flat_worlds import content, rectangle
from benchmarks.contacts.l1 import SAMPLES as L1_SAMPLES
from benchmarks.contacts.l1 import START, cost_map, scenario_a, scenario_a2, scenario_b
from benchmarks.contacts.samples import KEPT
from benchmarks.contacts.samples import SAMPLES as COUNTS
from benchmarks.measurements import Measurement
from jaxleas.contacts import ContactProblem, attempt, parse_problem
from jaxleas.files import atomic_path

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

FOOT_COLOURS = ("goldenrod", "tab:red")  # right, left: the left foot lands in phases 0, 2, ...


def draw_all(folder: Path, measured: Sequence[Measurement]) -> None:
    """Draw the three pictures into a folder."""
    by_name = {each.name: each for each in measured}
    _save(folder / "contacts_guide.png", _table_5_1(by_name))
    _save(folder / "contacts_samples.png", _figure_4_5(by_name))
    _save(folder / "contacts_l1.png", _figures_5_10_to_13())


def _new(columns: int, rows: int, size: tuple[float, float]) -> "tuple[Figure, list[Axes]]":
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=size, layout="constrained")
    FigureCanvasAgg(figure)
    return figure, list(np.ravel(figure.subplots(rows, columns)))


def _save(path: Path, figure: "Figure") -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    with atomic_path(path) as temporary:
        figure.savefig(temporary, dpi=80)


def _values(by_name: dict[str, Measurement], names: Sequence[str]) -> np.ndarray:
    found = [by_name[name].value for name in names]
    return np.array([np.nan if value is None else value for value in found])


def _table_5_1(by_name: dict[str, Measurement]) -> "Figure":
    figure, (ax,) = _new(1, 1, (7.0, 4.0))
    for how, colour, theirs in (
        ("with", "tab:blue", THESIS_WITH),
        ("without", "tab:orange", THESIS_WITHOUT),
    ):
        names = [f"contacts_course_{steps}_steps_{how}_guide" for steps in LENGTHS]
        ax.plot(LENGTHS, _values(by_name, names), "o-", color=colour, label=f"{how} guide")
        ax.plot(LENGTHS, theirs, "o--", color=colour, alpha=0.4, label=f"{how}, thesis (Gurobi)")
    ax.set_yscale("log")
    ax.set_xticks(LENGTHS)
    ax.set_xlabel("steps")
    ax.set_ylabel("time to plan [ms]")
    ax.legend(fontsize="small")
    return figure


def _figure_4_5(by_name: dict[str, Measurement]) -> "Figure":
    figure, axes = _new(2, 1, (10.0, 4.0))
    panels = (
        (axes[0], np.array(COUNTS), [f"{count}_samples" for count in COUNTS], "samples"),
        (axes[1], 2.0 * np.array(KEPT), [f"{2 * kept}_cm" for kept in KEPT], "step length [cm]"),
    )
    for ax, x, names, label in panels:
        success = _values(by_name, [f"contacts_sampling_{name}_success" for name in names])
        seconds = _values(by_name, [f"contacts_sampling_{name}_time" for name in names])
        ax.plot(x, success, "o-", color="tab:red")
        ax.set_ylim(0.0, 105.0)
        ax.set_xlabel(label)
        ax.set_ylabel("reached [%]", color="tab:red")
        other = ax.twinx()
        other.plot(x, seconds, "s-", color="tab:blue")
        other.set_ylim(bottom=0.0)
        other.set_ylabel("time to plan [ms]", color="tab:blue")
    axes[0].set_xscale("log")
    return figure


def _figures_5_10_to_13() -> "Figure":
    figure, axes = _new(4, 2, (13.0, 6.5))
    for ax, sample in zip(axes, L1_SAMPLES, strict=False):
        patches = {f"P{n}": rectangle(*each) for n, each in enumerate(sample)}
        described = content({**START, **patches}, [list(patches)], model="feet")
        problem = parse_problem("figure 5.10", described)
        _cost(ax, problem, tuple(patches), (0.0, 1.0, 0.0, 1.0))
    axes[0].set_title("5.10: cost of 1 to 4 surfaces")
    worked = (("5.11: A.1", scenario_a(0.0), 0), ("5.12: A.2", scenario_a2(), 0),
              ("5.13: B, third and fourth step", scenario_b(), 2))  # fmt: skip
    for ax, (title, described, phase) in zip(axes[4:], worked, strict=False):
        _scenario(ax, title, parse_problem(title, described), phase)
    axes[7].axis("off")
    axes[7].text(
        0.0, 0.5,
        "dark: low cost (T eq. 5.12)\nopen circles: the relaxation's footholds\n"
        "dots: the plan's; red left, yellow right\noutlined: the step's candidates",
    )  # fmt: skip
    return figure


def _scenario(ax: "Axes", title: str, problem: ContactProblem, phase: int) -> None:
    found = attempt(problem, pruning=False)
    assert found.relaxed is not None
    _cost(ax, problem, problem.steps[phase].candidates, (-0.35, 1.45, -0.6, 0.7))
    placed = None if found.placement is None else found.placement.footholds
    for feet, filled in ((found.relaxed.footholds, False), (placed, True)):
        for index, point in enumerate(() if feet is None else feet):
            colour = FOOT_COLOURS[(index + 1) % 2]
            ax.plot(
                *point[:2], "o", color=colour, markersize=4 if filled else 9,
                fillstyle="full" if filled else "none",
            )  # fmt: skip
    ax.set_title(f"{title}\n{found.undecided} undecided, {found.combinations} tried")


def _cost(
    ax: "Axes",
    problem: ContactProblem,
    names: tuple[str, ...],
    area: tuple[float, float, float, float],
) -> None:
    x, y = np.meshgrid(np.linspace(*area[:2], 120), np.linspace(*area[2:], 120))
    cost = cost_map(problem, names, np.stack([x, y, 0.0 * x], axis=-1))
    ax.contourf(x, y, cost, levels=24, cmap="magma")
    for name, surface in problem.surfaces.items():
        corners = np.concatenate([surface.vertices, surface.vertices[:1]])
        width = 2.0 if name in names else 0.8
        ax.plot(*corners[:, :2].T, color="white" if name in names else "0.6", linewidth=width)
    ax.set_xlim(area[:2])
    ax.set_ylim(area[2:])
    ax.set_aspect("equal")
