"""Tasks in this process, in other processes, or on Ray; a worker's death loses no task."""

from jaxleas.workers.processes import Here, ProcessWorkers, WorkerError, Workers, workers_for

__all__ = ["Here", "ProcessWorkers", "WorkerError", "Workers", "workers_for"]
