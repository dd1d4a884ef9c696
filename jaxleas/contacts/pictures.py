"""A contact plan from above and from the side: scene, guide, footholds, centre of mass."""

from itertools import cycle
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from jaxleas.contacts.landings import landings_of
from jaxleas.contacts.plan import ContactPlan
from jaxleas.contacts.problem import ContactProblem
from jaxleas.files import atomic_path
from jaxleas.robots import LIMB_OF_FOOT
from jaxleas.terrain import require_picture
from jaxleas.types import GuidePath

if TYPE_CHECKING:
    from matplotlib.axes import Axes

COLOURS = ("tab:red", "goldenrod", "tab:green", "tab:purple", "tab:cyan", "tab:brown")
"""Colours of the effectors, in the robot's order."""
FULL_NAMES = {name: f"{limb} foot" for name, limb in LIMB_OF_FOOT.items()}
GUIDE, COM, FAILED = "tab:blue", "black", "magenta"
VIEWS = {"above": (0, 1), "from the side": (0, 2)}
"""Coordinates that each view shows."""
MOST_MARKED = 120
"""A guide with more configurations is drawn as a line without dots."""
AROUND = 0.4  # margin shown beyond footholds and roots [m]


def draw_plan(
    path: str | Path,
    problem: ContactProblem,
    plan: ContactPlan,
    guide: GuidePath | None = None,
    made: ContactPlan | None = None,
) -> None:
    """Draw a plan, or where planning fails, in two views.

    Surfaces are grey, the guide blue, left feet red and right feet yellow, those of other robots in
    further colours, the centre of mass black. Without a plan, the candidates of the first step that
    cannot be made are outlined, the reason is the title, and the feet are those of `made`, if any.

    Args:
        path: path of the picture (.png, .svg, .pdf).
        problem: the contact problem.
        plan: answer to the problem.
        guide: guide path, which is drawn whole; the roots of the steps if None.
        made: plan for the steps before the first that cannot be made; None if there is none.

    Raises:
        InputError: the picture cannot be written, or is of an unknown type.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    require_picture(path)
    figure = Figure(figsize=(12, 7), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots(2, 1)
    kept = [step.root for step in problem.steps if step.root is not None]
    roots = np.array(kept).reshape(-1, 3) if guide is None else np.asarray(guide.position)
    for ax, (view, shown) in zip(axes, VIEWS.items(), strict=True):
        _draw_surfaces(ax, problem, plan, shown)
        _draw_guide(ax, roots, shown)
        _draw_contacts(ax, problem, plan if made is None else made, shown)
        _draw_stop(ax, plan, roots, shown)
        _frame(ax, problem, plan, roots, shown)
        ax.set_ylabel(f"{'xyz'[shown[1]]} [m], {view}")
    axes[1].set_xlabel("x [m]")
    axes[0].legend(loc="upper right", fontsize="small")
    figure.suptitle(_title(problem, plan), fontsize="medium", wrap=True)
    with atomic_path(path) as temporary:
        figure.savefig(temporary, dpi=110)


def _title(problem: ContactProblem, plan: ContactPlan) -> str:
    result = plan.status if plan.feasible else f"{plan.status}: {plan.reason}"
    how = "" if plan.postures is not None else f", model {problem.model}"
    return f"{plan.planner}{how}, {len(problem)} steps: {result}"


def _draw_surfaces(
    ax: "Axes", problem: ContactProblem, plan: ContactPlan, shown: tuple[int, int]
) -> None:
    used, failing = set(plan.surfaces), set(failing_candidates(problem, plan))
    for name, surface in problem.surfaces.items():
        if name in problem.parts and name not in used | failing:
            continue
        corners = surface.vertices[:, list(shown)]
        face = "0.72" if name in used else "0.88"
        edge, width = (FAILED, 2.0) if name in failing else ("0.4", 0.6)
        ax.fill(*corners.T, facecolor=face, edgecolor=edge, linewidth=width, zorder=1)


def failing_candidates(problem: ContactProblem, plan: ContactPlan) -> tuple[str, ...]:
    """Return the candidates of the first step that cannot be made; none if it is not known."""
    last = plan.last_feasible_step
    if plan.feasible or last is None or last + 1 >= len(problem):
        return ()
    return problem.steps[last + 1].candidates


def _draw_guide(ax: "Axes", roots: np.ndarray, shown: tuple[int, int]) -> None:
    if len(roots):
        marker = ".-" if len(roots) < MOST_MARKED else "-"
        ax.plot(*roots[:, list(shown)].T, marker, color=GUIDE, linewidth=1.2, label="guide")


def _draw_stop(ax: "Axes", plan: ContactPlan, roots: np.ndarray, shown: tuple[int, int]) -> None:
    """Mark the last configuration that a sampling plan reached, where it stops short."""
    if plan.feasible or not plan.postures:
        return
    here = roots[plan.postures[-1].configuration, list(shown)]
    ax.plot(*here, "x", color=FAILED, markersize=12, markeredgewidth=3, label="stopped", zorder=5)


def _draw_contacts(
    ax: "Axes", problem: ContactProblem, plan: ContactPlan, shown: tuple[int, int]
) -> None:
    """Draw what touches as it lies on its surface, seen along the third axis; points as dots."""
    places = [each.com for each in plan.postures or ()] if plan.com is None else plan.com
    if len(places):
        com = np.reshape(places, (-1, 3))[:, list(shown)]
        ax.plot(*com.T, "-", color=COM, linewidth=0.8, label="centre of mass", zorder=4)
    colours = dict(zip(problem.effectors, cycle(COLOURS), strict=False))
    labelled = set()
    for landing in landings_of(problem, plan):
        name = landing.effector
        corners = landing.corners[:, list(shown)].T
        label = None if name in labelled else FULL_NAMES.get(name, name)
        labelled.add(name)
        if corners.shape[1] == 1:
            ax.plot(*corners, ".", color=colours[name], label=label, zorder=3)
            continue
        ax.fill(
            *corners,
            facecolor=colours[name],
            edgecolor=colours[name],
            alpha=0.75,
            label=label,
            zorder=3,
        )


def _frame(
    ax: "Axes",
    problem: ContactProblem,
    plan: ContactPlan,
    roots: np.ndarray,
    shown: tuple[int, int],
) -> None:
    """Show the region that the robot crosses, not the whole scene."""
    points = [pose.position for pose in problem.initial.values()]
    points += list(roots)
    if plan.footholds is not None:
        points += list(plan.footholds)
    if not plan.feasible and plan.postures is None:
        names = {name for step in problem.steps for name in step.candidates}
        points += [corner for name in names for corner in problem.surfaces[name].vertices]
    here = np.array(points)[:, list(shown)]
    low, high = here.min(axis=0) - AROUND, here.max(axis=0) + AROUND
    ax.set_xlim(low[0], high[0])
    ax.set_ylim(low[1], high[1])
    ax.set_aspect("equal", adjustable="box")
