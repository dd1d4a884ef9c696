"""Points of contact with normals, headings and friction, for tests of equilibrium."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from jaxleas.types import InputError

_UNIT = 1e-6
LEAST_GENERATORS = 3


@dataclass(frozen=True, eq=False)
class ContactPoints:
    """Points of contact of one robot or of any batch of robots.

    Attributes:
        points: points of contact in the world [m].
        normals: unit contact normals, away from the surface.
        friction: friction coefficient mu of all points, or of each point [1].
        ahead: first axis of the contact that each point belongs to: the generators of the point's
            friction cone turn with it; None to align them with the world's y axis.
        generators: number of generators of each point's friction cone, linearised from inside.

    Raises:
        InputError: shapes disagree, a number is not finite or out of range.
    """

    points: Float[np.ndarray, "*batch P 3"]
    normals: Float[np.ndarray, "*batch P 3"]
    friction: float | Float[np.ndarray, "*#batch P"]
    ahead: Float[np.ndarray, "*batch P 3"] | None = None
    generators: int = 4

    def __post_init__(self) -> None:
        points, normals, ahead = self.points, self.normals, self.ahead
        if points.ndim < 2 or points.shape != normals.shape:
            raise InputError(
                f"points {points.shape} and normals {normals.shape} do not belong together: give"
                " [..., P, 3] for both"
            )
        if points.shape[-1] != 3 or points.shape[-2] < 1:
            raise InputError(f"points of shape {points.shape}: give at least one point of x, y, z")
        if ahead is not None and ahead.shape != points.shape:
            raise InputError(f"ahead {ahead.shape} must have the shape of the points")
        arrays = [points, normals, *([] if ahead is None else [ahead])]
        if not all(np.isfinite(array).all() for array in arrays):
            raise InputError("points, normals and ahead of contacts must be finite numbers")
        if np.abs(np.linalg.norm(normals, axis=-1) - 1.0).max(initial=0.0) > _UNIT:
            raise InputError("contact normals must have length 1")
        friction = np.asarray(self.friction, dtype=np.float64)
        if not (np.isfinite(friction).all() and (friction > 0.0).all()):
            raise InputError(f"friction {self.friction} must be a positive number")
        if self.generators < LEAST_GENERATORS:
            raise InputError(
                f"a friction cone needs {LEAST_GENERATORS} generators or more, not"
                f" {self.generators}"
            )

    @property
    def batch(self) -> tuple[int, ...]:
        """Shape of the batch of robots."""
        return self.points.shape[:-2]

    def flat(self) -> "ContactPoints":
        """Return the same contacts with a single batch axis."""
        shape = (-1, *self.points.shape[-2:])
        friction = self.friction
        if np.ndim(friction):
            friction = np.broadcast_to(friction, self.points.shape[:-1]).reshape(shape[:2])
        return ContactPoints(
            self.points.reshape(shape),
            self.normals.reshape(shape),
            friction,
            None if self.ahead is None else self.ahead.reshape(shape),
            self.generators,
        )
