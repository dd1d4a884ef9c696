"""Cores as devices: work divided among them is computed in parallel.

A core that computes its own half of everything is faster than two that share each operation: they
wait for each other less often, and what one wrote is still in its cache.
"""

import contextlib
import os

import jax

from jaxleas.training.config import PpoConfig

LEAST_ROBOTS = 16  # per core in a minibatch: with fewer, cores mostly wait for each other


def cores() -> int:
    """Return how many cores this process may use."""
    if hasattr(os, "sched_getaffinity"):  # not on every operating system
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def use_cores(count: int) -> None:
    """Let JAX treat the processor as several devices; call this before JAX touches any device.

    Devices of other kinds are left alone. A number that the user has chosen stays
    (JAX_NUM_CPU_DEVICES, or XLA_FLAGS), and so do devices that JAX has already initialised.

    Args:
        count: number of devices.
    """
    chosen = "xla_force_host_platform_device_count" in os.environ.get("XLA_FLAGS", "")
    if not chosen and "JAX_NUM_CPU_DEVICES" not in os.environ:
        with contextlib.suppress(RuntimeError):
            jax.config.update("jax_num_cpu_devices", count)


def share_cores(ppo: PpoConfig) -> None:
    """Let JAX use as many cores as share a training; call this before JAX touches any device."""
    use_cores(cores_that_share(ppo))


def cores_that_share(ppo: PpoConfig) -> int:
    """Return the most cores that share a minibatch's robots evenly, with enough robots for each."""
    robots = ppo.environments // ppo.minibatches
    return most_that_divide(robots, max(1, min(cores(), robots // LEAST_ROBOTS)))


def most_that_divide(robots: int, most: int) -> int:
    """Return the largest number up to `most` that divides the number of robots evenly."""
    return max(count for count in range(1, most + 1) if robots % count == 0)
