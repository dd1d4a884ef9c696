"""The sampling-based planner in the registry: it follows guide paths, many at once."""

from jaxleas.contacts.guide_from_problem import guide_from_problem, scene_of_problem
from jaxleas.contacts.plan import ContactPlan
from jaxleas.contacts.plan_sampling import CAUSE_OF_ENDING, plan_sampling
from jaxleas.contacts.planner import AskedGuide, AskedGuides, Grain, Planner, mean_step
from jaxleas.contacts.problem import ContactProblem
from jaxleas.contacts.sampling import SamplingPlan, SamplingSettings, plan_over
from jaxleas.robots import load_robot
from jaxleas.types import GuidePath, PathProgress, PlannerMeasures, Verdict


class Sampling(Planner):
    """The sampling-based planner in the registry."""

    title = "sampling"
    settings = SamplingSettings
    plan_settings = SamplingSettings
    needs = "guide"
    grain = Grain(task=64, shard=64, abreast=True)
    measures = frozenset({"robustness"})

    def plan(
        self,
        asked: ContactProblem | AskedGuide,
        settings: SamplingSettings,
        *,
        time_limit: float,
        diagnose: bool = True,
    ) -> ContactPlan:
        """Plan contacts along one guide path, or along a problem's roots."""
        if isinstance(asked, ContactProblem):
            asked = AskedGuide(asked.robot, guide_from_problem(asked), scene_of_problem(asked))
        robot = load_robot(asked.robot)
        return plan_sampling(asked.guide, asked.scene, settings, time_limit=time_limit, robot=robot)

    def judge(self, asked: AskedGuides, settings: SamplingSettings) -> list[Verdict]:
        """Judge guide paths, all together."""
        robot = load_robot(asked.robot)
        plans = plan_over(asked.scenes, asked.paths, asked.scene_index, settings, robot=robot)
        return [
            _verdict(number, path, plan)
            for (number, _, path), plan in zip(asked, plans, strict=True)
        ]


def _verdict(number: int, path: GuidePath, plan: SamplingPlan) -> Verdict:
    stood = len(plan) > 0
    progress = PathProgress(
        path=number,
        length=len(path),
        last_index=plan.last_index,
        reached=plan.reached,
        steps=plan.steps,
        mean_step=mean_step(path, plan.last_index, plan.steps),
    )
    measures = PlannerMeasures(
        repositions=plan.repositions,
        least_robustness=float(plan.robustness.min()) if stood else None,
        mean_robustness=float(plan.robustness.mean()) if stood else None,
    )
    if plan.ending == "reached":
        return Verdict.succeeded(progress, plan.seconds, measures)
    cause = CAUSE_OF_ENDING[plan.ending]
    return Verdict.stopped(progress, cause, plan.reason, plan.seconds, measures)
