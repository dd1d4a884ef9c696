"""Ask an exact planner many times, in parallel; verdict files with provenance."""

from jaxleas.labels.label import judge_shard, label_shards, plan_shards
from jaxleas.labels.planners import judge
from jaxleas.labels.shards import Shard, read_verdicts
from jaxleas.labels.verdict import Verdict

__all__ = [
    "Shard",
    "Verdict",
    "judge",
    "judge_shard",
    "label_shards",
    "plan_shards",
    "read_verdicts",
]
