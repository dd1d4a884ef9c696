"""The roll-out: every robot takes some steps with the present policy, on the device or the host."""

from jaxleas.training.walkers.device import make_walk
from jaxleas.training.walkers.host import HostWalker

__all__ = ["HostWalker", "make_walk"]
