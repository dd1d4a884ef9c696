"""Several processes, on one host or many, that train together; only process 0 writes files.

All run the same program and must meet in the same order, so they first agree on what only one of
them knows (a signal, the files on disk).
"""

from collections.abc import Callable

import jax
import numpy as np

from jaxleas.types import InputError, JaxleasError

AUTO = "auto"  # let JAX ask the cluster (Slurm, Open MPI, Kubernetes, TPU pods)


def connect(coordinator: str | None, process: str | None) -> None:
    """Join the other processes of a training; call this before anything touches a device.

    Args:
        coordinator: HOST:PORT of process 0, the same on all; or `auto`, to ask the cluster.
        process: `I/N`: this is process I of N, counted from 0; not with `auto`.

    Raises:
        InputError: the arguments are not understood, or the processes do not find each other.
    """
    where, index, count = None, None, None
    if coordinator != AUTO or process is not None:
        where = _parse_coordinator(coordinator)
        index, count = _parse_process(process)
    # Communication between CPUs; other devices bring their own.
    jax.config.update("jax_cpu_collectives_implementation", "gloo")
    try:
        jax.distributed.initialize(where, count, index)
    except (RuntimeError, ValueError) as error:
        raise InputError(f"--coordinator {coordinator}: cannot join: {error}") from error


def disconnect() -> None:
    """Part from the other processes, all at once: process 0 may have long work left to do."""
    jax.distributed.shutdown()


def is_first() -> bool:
    """Return whether this is process 0, the one that writes; a single process is process 0."""
    return jax.process_index() == 0


def any_process(asks: bool) -> bool:
    """Return, on every process, whether any of them asks; all must call it."""
    if jax.process_count() == 1:
        return asks
    from jax.experimental.multihost_utils import process_allgather

    return bool(np.any(process_allgather(np.array(asks))))


def from_first(make: Callable[[], str]) -> str:
    """Return, on every process, the text that process 0 makes; all must call it.

    Raises:
        JaxleasError: process 0 could not make it; on process 0 the error itself is raised, on the
            others one that refers to it.
    """
    if jax.process_count() == 1:
        return make()
    from jax.experimental.multihost_utils import broadcast_one_to_all

    text, failure = b"", None
    if is_first():
        try:
            text = make().encode()
        except JaxleasError as error:
            failure = error
    length = int(broadcast_one_to_all(np.int32(-1 if failure else len(text))))
    if failure is not None:
        raise failure
    if length < 0:
        raise InputError("process 0 could not begin; its own message says why")
    letters = np.frombuffer(text, np.uint8) if is_first() else np.zeros(length, np.uint8)
    return np.asarray(broadcast_one_to_all(letters), np.uint8).tobytes().decode()


def _parse_process(process: str | None) -> tuple[int, int]:
    index, slash, count = (process or "").partition("/")
    if not (slash and index.isdecimal() and count.isdecimal() and int(index) < int(count)):
        given = "is missing" if process is None else f"{process} is not understood"
        raise InputError(
            f"--process {given}: --process 0/2 with --coordinator HOST:PORT is the first of two"
        )
    return int(index), int(count)


def _parse_coordinator(coordinator: str | None) -> str:
    host, _, port = (coordinator or "").rpartition(":")
    if coordinator is None or not (host and port.isdecimal() and 0 < int(port) < 2**16):
        given = "is missing" if coordinator is None else f"{coordinator} is not understood"
        raise InputError(
            f"--coordinator {given}: HOST:PORT of process 0, as node1:12355, or {AUTO} would do"
        )
    return coordinator
