"""Settings that every contact planner has when it judges guide paths."""

from pydantic import PositiveInt

from jaxleas.configuration.strict import Strict


class PlannerSettings(Strict):
    """Base of a planner's settings: part of the provenance of every label."""

    keep_every: PositiveInt = 5
    """one guide configuration in so many is asked about"""
