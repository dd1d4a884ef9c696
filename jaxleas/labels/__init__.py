"""Ask an exact planner many times, in parallel; verdict files with provenance."""

from jaxleas.labels.judging import Judge
from jaxleas.labels.label import judge_shard, label_shards, plan_shards
from jaxleas.labels.own_planner import Outcome, OwnPlanner
from jaxleas.labels.planners import judge, judge_over
from jaxleas.labels.settings import MipSettings, PlannerSettings, Sl1mSettings
from jaxleas.labels.shards import Shard, read_verdicts
from jaxleas.labels.verdict import Verdict
from jaxleas.workers.processes import Here, ProcessWorkers, WorkerError, Workers

__all__ = [
    "Here",
    "Judge",
    "MipSettings",
    "Outcome",
    "OwnPlanner",
    "PlannerSettings",
    "ProcessWorkers",
    "Shard",
    "Sl1mSettings",
    "Verdict",
    "WorkerError",
    "Workers",
    "judge",
    "judge_over",
    "judge_shard",
    "label_shards",
    "plan_shards",
    "read_verdicts",
]
