"""The sampling-based contact planner (T 4.1)."""

from jaxleas.contacts.sampling.plan import SamplingPlan
from jaxleas.contacts.sampling.planner import plan_contacts, plan_many, plan_over
from jaxleas.contacts.sampling.settings import SamplingSettings

__all__ = ["SamplingPlan", "SamplingSettings", "plan_contacts", "plan_many", "plan_over"]
