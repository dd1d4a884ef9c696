"""Cores as devices: the members of a population are divided among them."""

from jaxleas.training.cores import cores, use_cores


def use_all_cores() -> None:
    """Let JAX take every core of a processor for a device; to be called before it touches any."""
    use_cores(cores())
