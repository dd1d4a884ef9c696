"""Tasks in this process, in others, or on Ray; a worker that dies costs nothing."""

from jaxleas.workers.processes import Here, ProcessWorkers, WorkerError, Workers, workers_for

__all__ = ["Here", "ProcessWorkers", "WorkerError", "Workers", "workers_for"]
