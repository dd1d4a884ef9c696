"""Contact problems, their exact planners (mixed-integer, SL1M, sampling) and certificates."""

from jaxleas.contacts.certificate import Violation, certify
from jaxleas.contacts.from_guide import Stepping, problem_from_guide
from jaxleas.contacts.guide_file import read_guide_path
from jaxleas.contacts.plan import ContactPlan, read_plan, write_plan
from jaxleas.contacts.plan_sampling import plan_sampling
from jaxleas.contacts.planner import PlannerError
from jaxleas.contacts.polytopes import StepPolytopes, load_step_polytopes
from jaxleas.contacts.posture import Posture
from jaxleas.contacts.posture_certificate import certify_postures
from jaxleas.contacts.problem import ContactProblem, FootPose, Phase, Step
from jaxleas.contacts.problem_file import read_problem, write_problem
from jaxleas.contacts.programs.mip import plan_mip
from jaxleas.contacts.programs.prefix import last_feasible_phase
from jaxleas.contacts.programs.sl1m import plan_sl1m
from jaxleas.contacts.registry import PLANNERS, find_planner
from jaxleas.contacts.stance_certificate import StanceCertificate, certify_stance
from jaxleas.contacts.stances import stances_of
from jaxleas.contacts.surfaces import ContactSurface

__all__ = [
    "PLANNERS",
    "ContactPlan",
    "ContactProblem",
    "ContactSurface",
    "FootPose",
    "Phase",
    "PlannerError",
    "Posture",
    "StanceCertificate",
    "Step",
    "StepPolytopes",
    "Stepping",
    "Violation",
    "certify",
    "certify_postures",
    "certify_stance",
    "find_planner",
    "last_feasible_phase",
    "load_step_polytopes",
    "plan_mip",
    "plan_sampling",
    "plan_sl1m",
    "problem_from_guide",
    "read_guide_path",
    "read_plan",
    "read_problem",
    "stances_of",
    "write_plan",
    "write_problem",
]
