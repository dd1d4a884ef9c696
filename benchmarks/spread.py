"""What is measured is divided among the devices as a training is."""

import jax

from jaxleas.training.cores import most_that_divide
from jaxleas.training.devices import Devices


def all_devices(count: int) -> Devices:
    """Return JAX's devices, as many as share so many robots evenly."""
    there = jax.devices()
    return Devices.of(there[: most_that_divide(count, len(there))])
