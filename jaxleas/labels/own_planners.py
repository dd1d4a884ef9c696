"""Names of other rooms that go with labels: planners of your own, settings, verdicts, workers."""

from jaxleas.contacts import (
    AskedGuides,
    AstarSettings,
    MipSettings,
    Outcome,
    OwnPlanner,
    PlannerAnswer,
    PlannerSettings,
    Sl1mSettings,
)
from jaxleas.types import Verdict
from jaxleas.workers import Here, ProcessWorkers, WorkerError, Workers

__all__ = [
    "AskedGuides",
    "AstarSettings",
    "Here",
    "MipSettings",
    "Outcome",
    "OwnPlanner",
    "PlannerAnswer",
    "PlannerSettings",
    "ProcessWorkers",
    "Sl1mSettings",
    "Verdict",
    "WorkerError",
    "Workers",
]
