"""All workloads, in the order of the table."""

from benchmarks.workloads.compilation import COMPILATION
from benchmarks.workloads.environment import ENVIRONMENT
from benchmarks.workloads.export import EXPORT
from benchmarks.workloads.learning import LEARNING
from benchmarks.workloads.machine import MACHINE
from benchmarks.workloads.memory import MEMORY
from benchmarks.workloads.surrogate import SURROGATE
from benchmarks.workloads.training import TRAINING
from benchmarks.workloads.walking import WALKING
from benchmarks.workloads.workload import Workload

WORKLOADS: tuple[Workload, ...] = (
    *MACHINE,
    *ENVIRONMENT,
    SURROGATE,
    *TRAINING,
    COMPILATION,
    MEMORY,
    *EXPORT,
    LEARNING,
    WALKING,
)
