"""What a gait plan is worth, found by code that did not produce it.

Each transition is rebuilt from the plan. HiGHS finds its margin from the definition of the program,
and, along the curve that the compiled solver chose, forces at 50 instants. The ground must be level
at eight points around each foothold, and below the trunk.
"""

from collections.abc import Callable
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from jaxleas.dynamics import (
    Discretisation,
    certify_transition,
    margins_by_definition,
    one_of,
    solve_transitions,
)
from jaxleas.envs.gait_planning import FEET, GaitPlanningConfig, in_contact
from jaxleas.gaits.gait import transitions_along
from jaxleas.gaits.gait_plan import GaitPlan
from jaxleas.terrain import HeightMap
from jaxleas.types import is_ground

AROUND = 8
"""Points around a foothold at which the ground is asked."""
WITHIN = 0.02
"""Slack below zero between the instants of the program that is still accepted [1]: 2 mm of reach,
or 2 % of the body's weight."""


@dataclass(frozen=True)
class GaitCertificate:
    """What was found of a plan.

    Attributes:
        transitions: number of transitions.
        confirmed: number of transitions whose program HiGHS finds feasible.
        least_margin: least margin of the programs, by HiGHS [1].
        least_slack: least slack of the curves at 50 instants each [1].
        weakest: what has that slack, and in which transition.
        unsafe: footholds whose surroundings are not level, as FOOT of phase N.
        trunk: phases in which the terrain reaches the trunk.
    """

    transitions: int
    confirmed: int
    least_margin: float
    least_slack: float
    weakest: str
    unsafe: tuple[str, ...]
    trunk: tuple[int, ...]

    @property
    def holds(self) -> bool:
        """Whether the plan holds."""
        return (
            self.confirmed == self.transitions
            and self.least_slack >= -WITHIN
            and not self.unsafe
            and not self.trunk
        )

    def in_words(self) -> str:
        """Return the result as a sentence."""
        found = (
            f"HiGHS confirms {self.confirmed} of {self.transitions} transitions, least margin"
            f" {self.least_margin:.4f}; at 50 instants each the least slack is"
            f" {self.least_slack:.4f} ({self.weakest})"
        )
        if self.unsafe:
            found += f"; unsafe footholds: {', '.join(self.unsafe)}"
        if self.trunk:
            found += f"; the terrain reaches the trunk in phases {', '.join(map(str, self.trunk))}"
        return found

    def to_json(self) -> dict[str, Any]:
        """Return plain values."""
        return asdict(self) | {"holds": self.holds}


def certify_gait(
    plan: GaitPlan, terrain: HeightMap, say: Callable[[int], None] = lambda done: None
) -> GaitCertificate:
    """Return what a plan is worth on a terrain.

    Args:
        plan: plan.
        terrain: height map that it is for.
        say: function that is told the number of transitions certified.

    Raises:
        JaxleasError: HiGHS found no answer.
    """
    unsafe, trunk = _unsafe_footholds(plan, terrain), _touches(plan, terrain)
    if not plan.length:
        return GaitCertificate(0, 0, 0.0, 0.0, "no transition", unsafe, trunk)
    config = GaitPlanningConfig(robot=plan.robot, instants=plan.program.instants)
    where = Discretisation(instants=plan.program.instants)
    transitions = transitions_along(config, plan.phases, plan.times)
    solved = solve_transitions(transitions, where)
    margins, slacks, weakest = [], [], []
    for row in range(plan.length):
        one = one_of(transitions, row)
        margins.append(float(margins_by_definition(one, where)))
        found = certify_transition(one, where, solved.free_point[row], solved.forces[row])
        slacks.append(found.margin)
        weakest.append(found.weakest[0])
        say(row + 1)
    least = int(np.argmin(slacks))
    confirmed = sum(margin >= plan.program.least_margin - 1e-6 for margin in margins)
    name = f"{weakest[least]} in transition {least}"
    return GaitCertificate(plan.length, confirmed, min(margins), slacks[least], name, unsafe, trunk)


def _unsafe_footholds(plan: GaitPlan, terrain: HeightMap) -> tuple[str, ...]:
    """Return the footholds around which eight points differ in height from the foot."""
    angles = np.arange(AROUND) * (2.0 * np.pi / AROUND)
    # A point of the circle may lie in a cell that is half a cell farther.
    radius = max(plan.program.foot_clearance - terrain.resolution, 0.0)
    circle = radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    feet, standing = plan.phases.feet, in_contact(plan.phases.support)
    points = feet[:, :, None, :2] + circle
    heights = terrain.height_at(points.reshape(-1, 2)).reshape(points.shape[:-1])
    level = np.abs(heights - feet[..., 2:]) <= plan.program.edge_rise
    rows = np.argwhere(standing & ~level.all(axis=2))
    return tuple(f"{FEET[foot]} of phase {phase}" for phase, foot in rows)


def _touches(plan: GaitPlan, terrain: HeightMap) -> tuple[int, ...]:
    """Return the phases in which a cell below the trunk is as high as the trunk."""
    rows, columns = np.indices(terrain.shape)
    x = terrain.origin[0] + columns * terrain.resolution
    y = terrain.origin[1] + rows * terrain.resolution
    half_length, half_width = plan.robot.trunk_half
    touched = []
    for number, (com, yaw) in enumerate(zip(plan.phases.com, plan.phases.yaw, strict=True)):
        ahead = np.cos(yaw) * (x - com[0]) + np.sin(yaw) * (y - com[1])
        left = np.cos(yaw) * (y - com[1]) - np.sin(yaw) * (x - com[0])
        below = (np.abs(ahead) <= half_length) & (np.abs(left) <= half_width)
        heights = terrain.heights[below]
        high = heights[is_ground(heights)].max(initial=-np.inf)
        if high >= com[2] + plan.robot.trunk_bottom:
            touched.append(number)
    return tuple(touched)
