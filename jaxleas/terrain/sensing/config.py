"""The model of a map from sensors: what is wrong with the heights that a robot sees."""

from collections.abc import Sequence
from typing import Annotated, Any

from pydantic import Field

from jaxleas.configuration import Fraction, Strict, parse_yaml, with_values
from jaxleas.types import InputError

Deviation = Annotated[float, Field(ge=0.0, le=0.2)]
MAX_WIDTH = 2.0
"""Largest hole, and longest correlation [m]."""


class NoiseConfig(Strict):
    """What is wrong with the maps that robots see; by default nothing.

    Conditions are judged on the true terrain; the policy and its guard see the map.
    """

    white: Deviation = 0.0
    """standard deviation of an error that each cell has by itself [m]"""
    correlated: Deviation = 0.0
    """standard deviation of an error that neighbouring cells share [m]"""
    correlation: Annotated[float, Field(ge=0.02, le=MAX_WIDTH)] = 0.3
    """distance at which the correlation of that error has fallen to 1/e [m]"""
    drift: Annotated[float, Field(ge=0.0, le=0.2)] = 0.0
    """slope by which the map is tilted about the root [m of height per m of distance]: what is far
    is off by more; each map has a direction of its own, fixed to the root"""
    missing: Fraction = 0.0
    """share of cells whose height is missing, each by itself"""
    holes: Fraction = 0.0
    """share of the area that lies in square holes of missing cells"""
    hole_width: Annotated[float, Field(ge=0.02, le=MAX_WIDTH)] = 0.2
    """side of such a hole [m]"""
    fill: Annotated[float, Field(ge=0.0, le=0.5)] = 0.08
    """width up to which gaps of missing cells are filled from their rims [m]; what is left is
    unknown, and seen as no ground"""
    quantisation: Annotated[float, Field(ge=0.0, le=0.2)] = 0.0
    """step to a whole number of which heights are rounded [m]"""
    delay: Annotated[int, Field(ge=0, le=10)] = 0
    """number of time steps by which the map is late: it lies around the root as it was placed
    then"""

    @property
    def is_none(self) -> bool:
        """Whether the map is the true terrain."""
        wrong = (self.white, self.correlated, self.drift, self.missing, self.holes)
        return not any((*wrong, self.quantisation, self.delay))

    @property
    def loses_cells(self) -> bool:
        """Whether cells are missing."""
        return bool(self.missing or self.holes)


def noise_of(words: Sequence[str] | None) -> NoiseConfig | None:
    """Return the noise that words of a command line state; None: none is stated.

    Args:
        words: settings as NAME=VALUE.

    Raises:
        InputError: a word is no such pair, names no setting, or its value is out of range.
    """
    stated: dict[str, Any] = {}
    for word in words or ():
        name, equals, text = word.partition("=")
        if not (name and equals and text):
            raise InputError(f"--noise {word}: settings look like white=0.02")
        try:
            stated[name] = parse_yaml(text)
        except ValueError as error:
            raise InputError(f"--noise {word}: {text} is not YAML") from error
    noise = with_values(NoiseConfig(), stated, "--noise")
    return None if noise.is_none else noise
