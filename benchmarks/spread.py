"""Measurements divided among the devices, as in training."""

import jax

from jaxleas.training import Devices, most_that_divide


def all_devices(count: int) -> Devices:
    """Return the largest number of JAX's devices that share a number of robots evenly."""
    there = jax.devices()
    return Devices.of(there[: most_that_divide(count, len(there))])
