"""A contact plan on the surfaces found in a noisy map, judged on the true scene."""

from dataclasses import dataclass, replace

import numpy as np

from benchmarks.maps.walks import Walk
from jaxleas.contacts import ContactPlan, ContactProblem, plan_mip, problem_from_guide
from jaxleas.contacts.from_guide import NoGroundError
from jaxleas.contacts.surfaces import make_surface
from jaxleas.terrain import HeightMap, PlaneSearch, Scene, find_surfaces, rasterise
from jaxleas.terrain.loading import scene_of_surfaces

CELL, NOISE = 0.02, 0.01  # of the maps [m]
GOOD = 0.02  # distance from true ground within which a foot stands well [m]
ROBOT = "talos"


@dataclass(frozen=True)
class Judgement:
    """What became of a guide path.

    Attributes:
        planned: whether there is a plan.
        worst: largest distance of a foot from true ground [m]; 0 without a plan.
        feet: number of feet placed.
        over: number of feet with a corner of the sole more than 2 cm above what is under it.
    """

    planned: bool
    worst: float = 0.0
    feet: int = 0
    over: int = 0

    @property
    def good(self) -> bool:
        """Whether there is a plan whose feet all stand on true ground."""
        return self.planned and self.worst <= GOOD


class Terrain:
    """The terrain of a walk: its maps are made once for all walks that follow on it."""

    def __init__(self, scene: Scene, number: int) -> None:
        self.scene, self.number = scene, number
        self.truth = [make_surface(each, "true surface") for each in scene.walkable.values()]
        self.ground = rasterise(scene, 0.5 * CELL)
        self._found: dict[tuple[int, float | None], Scene] = {}

    def found(self, seed: int, inset: float | None) -> Scene:
        """Return the surfaces found in the terrain's map with white noise."""
        if (seed, inset) not in self._found:
            exact = rasterise(self.scene, CELL)
            noise = NOISE * np.random.default_rng([seed, self.number]).normal(size=exact.shape)
            heights = (exact.heights + noise).astype(np.float32)
            found = find_surfaces(replace(exact, heights=heights), PlaneSearch(inset=inset))
            self._found[seed, inset] = scene_of_surfaces(found)
        return self._found[seed, inset]


_LAST: list[Terrain] = []  # of this process


def _terrain(walk: Walk) -> Terrain:
    if not (_LAST and _LAST[0].number == walk.number):
        _LAST[:] = [Terrain(walk.scene, walk.number)]
    return _LAST[0]


def judged(walk: Walk, seed: int | None, inset: float | None = None) -> Judgement:
    """Plan a walk on its true scene, or on the surfaces found in a map with a seed of noise.

    Args:
        walk: guide path and its terrain.
        seed: seed of the noise; None: the true scene.
        inset: length by which the surfaces found are drawn in from their edges [m].
    """
    terrain = _terrain(walk)
    scene = walk.scene if seed is None else terrain.found(seed, inset)
    try:
        problem = problem_from_guide(walk.path, scene, ROBOT)
    except NoGroundError:
        return Judgement(planned=False)
    plan = plan_mip(problem, diagnose=False)
    if not plan.feasible or plan.footholds is None:
        return Judgement(planned=False)
    off = np.min([each.distance(plan.footholds) for each in terrain.truth], axis=0)
    over = _over_edges(problem, plan, terrain.ground)
    return Judgement(True, float(off.max()), len(off), over)


def _over_edges(problem: ContactProblem, plan: ContactPlan, ground: HeightMap) -> int:
    """Return the number of feet with a corner of the sole over an edge."""
    assert plan.footholds is not None
    count = 0
    for step, name, foot in zip(problem.steps, plan.surfaces, plan.footholds, strict=True):
        half = problem.half_sizes[step.foot]
        signs = np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]])
        forward = np.array([np.cos(step.yaw), np.sin(step.yaw)])
        axes = np.stack([forward, [-forward[1], forward[0]]])
        corners = foot[:2] + (signs * half) @ axes
        normal = problem.surfaces[name].normal
        sole = foot[2] - (corners - foot[:2]) @ normal[:2] / normal[2]
        gap = sole - ground.height_at(corners)
        count += not (gap <= GOOD).all()  # no ground is NaN
    return count
