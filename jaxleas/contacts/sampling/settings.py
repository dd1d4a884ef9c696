"""Settings of the sampling-based planner (T 4.1.4)."""

from typing import Annotated, Literal

from pydantic import Field, NonNegativeInt, PositiveFloat, PositiveInt

from jaxleas.contacts.settings import PlannerSettings

Heuristic = Literal["fixed_step", "manipulability", "effort", "reference"]


class SamplingSettings(PlannerSettings):
    """Settings of the sampling-based planner; the defaults are the published ones for Talos."""

    samples: Annotated[int, Field(ge=1, le=1_000_000)] = 25_000
    """configurations of each kind of leg in the data base; mirror images are of one kind"""
    seed: NonNegativeInt = 0
    """of the data base"""
    keep_every: PositiveInt = 5
    """interval between planned configurations of the guide; 5 makes about 10 cm"""
    heuristic: Heuristic = "fixed_step"
    """by which candidates are tried, best first"""
    look_ahead: PositiveFloat = 0.6
    """fixed_step aims at the foot of the root this long ahead [s]"""
    contact_distance: PositiveFloat = 0.02
    """a sample nearer than this to a surface is a candidate for it [m]"""
    contact_lift: PositiveFloat = 0.001
    """gap between a standing sole and its surface [m]"""
    least_robustness: float = 2.0
    """every posture's robustness of equilibrium is at least this [N]"""
    friction_generators: Annotated[int, Field(ge=3, le=64)] = 6
    """of each contact point's cone, turned with the foot: more refuse fewer tilted stones"""
    max_tries: PositiveInt = 2
    """failures in a row, each but the last mended by a reposition, after which to stop; robots with
    more than two feet have as many times the repositions as there are other feet"""
    max_repositions: NonNegativeInt = 20
    """of a whole plan"""
    moved: PositiveFloat = 0.01
    """a contact that moves by less counts as the same one [m]"""
    stages: tuple[PositiveInt, ...] = (24, 200)
    """number of candidates that are tried together, before the next as many"""
