"""What a walk is planned with: motion models, foot cost map, and a proposal if one is given."""

from collections.abc import Sequence
from pathlib import Path

from jaxleas.controllers import Controller
from jaxleas.crossing.walk_settings import WalkSettings
from jaxleas.footsteps import (
    FootCostMap,
    FootstepPlanner,
    Goal,
    MotionModel,
    Planner,
    ProposalSession,
    ProposedPlanner,
    buffer_of,
    read_motion_model,
    read_proposal,
    require_footing,
    require_goal,
    shipped_model,
    shipped_proposal,
)
from jaxleas.terrain import HeightMap


def model_of(models: Path | None, walker: Controller) -> MotionModel:
    """Return motion models of the controller that walks."""
    if models is None:
        return shipped_model(walker.identity)
    model = read_motion_model(models)
    walker.identity.require_same(model.controller, str(models), "the walk")
    return model


def planner_of(
    proposal: str | None, model: MotionModel, costs: FootCostMap, settings: WalkSettings
) -> Planner:
    """Return the planner, with a proposal that is asked before it if one is given."""
    if proposal is None:
        return FootstepPlanner(model, costs, settings.search)
    is_shipped = proposal == SHIPPED
    learned = shipped_proposal(model.controller) if is_shipped else read_proposal(proposal)
    learned.require_fits(model, "the package's proposal" if is_shipped else proposal)
    return ProposedPlanner(ProposalSession(learned), model, costs, settings.search)


SHIPPED = "shipped"
"""In place of a file: the proposal that comes with the package."""


def costs_of(
    model: MotionModel, height_map: HeightMap, goals: Sequence[Goal], settings: WalkSettings
) -> FootCostMap:
    """Return the foot cost map of the robot's map, on which all goals are."""
    buffer = buffer_of(model) if settings.buffer is None else settings.buffer
    costs = FootCostMap.of(height_map, buffer)
    for goal in goals:
        require_goal(goal, costs)
        require_footing(goal, costs)
    return costs
