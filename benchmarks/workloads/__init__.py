"""The workloads: each names its metrics and measures them."""

from benchmarks.workloads.catalogue import WORKLOADS
from benchmarks.workloads.workload import Workload

__all__ = ["WORKLOADS", "Workload"]
