"""A plan of the steps along a guide path, whose trunk must be free as well."""

from typing import Any

from jaxleas.contacts.plan import ContactPlan
from jaxleas.contacts.planner import AskedGuide, Planner
from jaxleas.contacts.problem import ContactProblem
from jaxleas.contacts.stepping import kept_configurations
from jaxleas.contacts.trunk import trunk_collision
from jaxleas.robots import load_robot


def plan_along(
    planner: Planner,
    asked: AskedGuide,
    problem: ContactProblem,
    every: int,
    settings: Any,
    time_limit: float,
) -> ContactPlan:
    """Plan the steps of a guide path, unless its trunk touches an obstacle.

    In that case no plan follows the path: the answer says where, and how many steps can be made
    before.

    Args:
        planner: planner of contact problems.
        asked: guide path, with scene and robot.
        problem: problem made of the guide path, a step for each kept configuration.
        every: number N: every N-th configuration is kept.
        settings: settings of the plan.
        time_limit: time limit [s].
    """
    touched = trunk_collision(load_robot(asked.robot), asked.scene, asked.guide)
    if touched is None:
        return planner.plan(problem, settings, time_limit=time_limit)
    kept = kept_configurations(len(asked.guide), every)
    steps = sum(index < touched.index for index in kept)
    answer = ContactPlan(planner.name, False, "infeasible")
    if steps:
        answer = planner.plan(problem.prefix(steps), settings, time_limit=time_limit)
        if not answer.feasible:
            return answer
    return ContactPlan(
        planner=planner.name,
        feasible=False,
        status="infeasible",
        reason=touched.sentence,
        last_feasible_step=steps - 1,
        seconds=answer.seconds,
        combinations=answer.combinations,
        undecided=answer.undecided,
        cause="collision",
    )
