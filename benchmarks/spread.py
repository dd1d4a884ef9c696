"""What is measured is divided among the devices as a training is."""

import jax

from jaxleas.training.devices import Devices


def all_devices(count: int) -> Devices:
    """Return JAX's devices, as many as share so many robots evenly."""
    there = jax.devices()
    return Devices.of(there[: max(n for n in range(1, len(there) + 1) if count % n == 0)])
