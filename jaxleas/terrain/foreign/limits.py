"""What a process that reads a stranger's file may take."""

import resource
import signal
from pathlib import Path

MEMORY = 3 * 2**30
"""Address space beyond what the process has at the start [bytes]."""
CPU_SECONDS = 60
WALL_SECONDS = 120
MAX_ANSWER = 2**30
"""Largest file that the process may write [bytes]."""


def limit_this_process() -> None:
    """Bound memory, time and written bytes of this process; beyond them it ends."""
    resource.setrlimit(resource.RLIMIT_CPU, (CPU_SECONDS, CPU_SECONDS))
    resource.setrlimit(resource.RLIMIT_FSIZE, (MAX_ANSWER, MAX_ANSWER))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    statm = Path("/proc/self/statm")
    if statm.is_file():  # elsewhere the address space says nothing about memory
        used = int(statm.read_text().split()[0]) * resource.getpagesize()
        resource.setrlimit(resource.RLIMIT_AS, (used + MEMORY, used + MEMORY))
    signal.alarm(WALL_SECONDS)  # its default is to end the process
