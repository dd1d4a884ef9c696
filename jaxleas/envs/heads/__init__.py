"""Heads of a policy: how the parts of an action are distributed and scaled."""

from jaxleas.envs.heads.cases import Cases
from jaxleas.envs.heads.categorical import Categorical
from jaxleas.envs.heads.head import Head
from jaxleas.envs.heads.normal import Normal
from jaxleas.envs.heads.scales import Ball, Interval, Scale

__all__ = ["Ball", "Cases", "Categorical", "Head", "Interval", "Normal", "Scale"]
