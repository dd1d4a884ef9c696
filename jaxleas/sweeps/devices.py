"""Cores as devices: the members of a population are divided among them."""

from jaxleas.training import cores, use_cores


def use_all_cores() -> None:
    """Let JAX treat every core as a device; call this before JAX touches any device."""
    use_cores(cores())
