"""Cores as devices: the members of a population are divided among them."""

import os

import jax


def use_all_cores() -> None:
    """Let JAX take every core of a processor for a device; to be called before it touches any.

    Devices of other kinds are what they are. A number the user has chosen stays
    (JAX_NUM_CPU_DEVICES, or XLA_FLAGS).
    """
    chosen = "xla_force_host_platform_device_count" in os.environ.get("XLA_FLAGS", "")
    if not chosen and "JAX_NUM_CPU_DEVICES" not in os.environ:
        jax.config.update("jax_num_cpu_devices", len(os.sched_getaffinity(0)))
