"""Controllers that take turns on the way: each robot gets the one that its plan is of."""

from collections.abc import Sequence
from dataclasses import replace

from jaxleas.controllers import Controller, Switching, Walking
from jaxleas.footsteps import FootstepPlan


def take_turns(
    walking: Walking, plans: Sequence[FootstepPlan | None], controller: Controller
) -> tuple[Walking, list[int]]:
    """Return the robots with the controllers of their plans, and those whose controller begins.

    Args:
        walking: robots.
        plans: plan that each walks; None leaves its controller.
        controller: controller of all of them; only a `Switching` has others.
    """
    if not isinstance(controller, Switching):
        return walking, []
    names = [each.identity.name for each in controller.controllers]
    before = walking.memory.chosen
    chosen = before.copy()
    for index, plan in enumerate(plans):
        if plan is not None and plan.controller in names:
            chosen[index] = names.index(plan.controller)
    begun = [index for index in range(len(plans)) if chosen[index] != before[index]]
    if not begun:
        return walking, begun
    memory = controller.switched(walking.memory, walking.state, chosen)
    return replace(walking, memory=memory), begun
