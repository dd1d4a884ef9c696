"""Forces: friction cones, static equilibrium."""

from jaxleas.dynamics.equilibrium import equilibrium_robustness
from jaxleas.dynamics.friction import friction_generators

__all__ = ["equilibrium_robustness", "friction_generators"]
