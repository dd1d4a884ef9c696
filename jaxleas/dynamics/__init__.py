"""Forces: friction cones, static equilibrium."""

from jaxleas.dynamics.contact_points import ContactPoints
from jaxleas.dynamics.equilibrium import equilibrium_robustness, robustness_of
from jaxleas.dynamics.exact_cone import exact_robustness
from jaxleas.dynamics.friction import friction_generators

__all__ = [
    "ContactPoints",
    "equilibrium_robustness",
    "exact_robustness",
    "friction_generators",
    "robustness_of",
]
