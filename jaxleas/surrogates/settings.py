"""Settings of a fit: the only place of these settings and their defaults."""

from typing import Annotated

from pydantic import Field

from jaxleas.configuration import Strict


class FitSettings(Strict):
    """Settings of the fit of a surrogate."""

    code: Annotated[int, Field(ge=1)] = 24
    """Number of outputs of the encoder."""
    hidden: Annotated[int, Field(ge=1)] = 16
    """Number of values that are carried from one kept configuration to the next."""
    epochs: Annotated[int, Field(ge=1)] = 12
    """Number of passes over the paths."""
    minibatch: Annotated[int, Field(ge=1)] = 128
    """Walks per gradient step."""
    learning_rate: Annotated[float, Field(gt=0.0)] = 3e-3
    """Learning rate at the start; it falls to zero along a cosine."""
    weight_decay: Annotated[float, Field(ge=0.0)] = 0.03
    mirror: bool = True
    """Learn from each path's mirror image as often as from the path itself."""
    held_out: Annotated[float, Field(gt=0.0, lt=1.0)] = 0.25
    """Share of the terrains held out from learning: half of it calibrates, half judges."""
    seed: Annotated[int, Field(ge=0)] = 0
