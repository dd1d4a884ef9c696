"""Ask an exact planner many times, in parallel; verdict files with provenance."""

from jaxleas.contacts.own_planner import Outcome, OwnPlanner, PlannerAnswer
from jaxleas.contacts.planner import AskedGuides
from jaxleas.contacts.programs.settings import MipSettings, Sl1mSettings
from jaxleas.contacts.settings import PlannerSettings
from jaxleas.labels.judging import Judge
from jaxleas.labels.label import judge_shard, label_shards, plan_shards
from jaxleas.labels.oracle import Oracle
from jaxleas.labels.planners import ask, judge, judge_over
from jaxleas.labels.shards import Shard, read_verdicts
from jaxleas.types import Verdict
from jaxleas.workers.processes import Here, ProcessWorkers, WorkerError, Workers

__all__ = [
    "AskedGuides",
    "Here",
    "Judge",
    "MipSettings",
    "Oracle",
    "Outcome",
    "OwnPlanner",
    "PlannerAnswer",
    "PlannerSettings",
    "ProcessWorkers",
    "Shard",
    "Sl1mSettings",
    "Verdict",
    "WorkerError",
    "Workers",
    "ask",
    "judge",
    "judge_over",
    "judge_shard",
    "label_shards",
    "plan_shards",
    "read_verdicts",
]
