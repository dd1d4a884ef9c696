"""Convex polytopes K x <= k, on the host in float64."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Bool, Float
from scipy.optimize import linprog
from scipy.spatial import ConvexHull, HalfspaceIntersection, QhullError

from jaxleas.geometry.boxes import Box
from jaxleas.types import InputError

_SAME_FACE = 1e-7  # largest difference of faces in one plane that the hull's triangulation split
MAX_FACES = 10_000
_ON_FACE = 1e-7  # largest distance of a vertex that lies on a face [m]


@dataclass(frozen=True, eq=False)
class Polytope:
    """The bounded convex set {x : K x <= k}, with unit rows in K.

    Attributes:
        normals: outward unit normals of the faces, K.
        offsets: distance of each face from the origin along its normal, k [m].

    Raises:
        InputError: shapes disagree, or a number is not finite.
    """

    normals: Float[np.ndarray, "F 3"]
    offsets: Float[np.ndarray, " F"]

    def __post_init__(self) -> None:
        if len(self.offsets) > MAX_FACES:
            raise InputError(f"a polytope of {len(self.offsets)} faces; at most {MAX_FACES}")
        if self.normals.shape != (len(self.offsets), 3):
            raise InputError(
                f"a polytope needs one normal of three numbers for each of its "
                f"{len(self.offsets)} offsets, got an array of shape {self.normals.shape}"
            )
        if not (np.isfinite(self.normals).all() and np.isfinite(self.offsets).all()):
            raise InputError("a polytope's normals and offsets must be finite numbers")

    @classmethod
    def from_points(cls, points: Float[np.ndarray, "P 3"]) -> "Polytope":
        """Return the convex hull of `points` [m], with each plane once.

        Raises:
            InputError: the points span no volume.
        """
        try:
            equations = ConvexHull(points).equations
        except (QhullError, ValueError) as error:
            raise InputError(f"these {len(points)} points span no volume") from error
        keys = np.round(equations / _SAME_FACE).astype(np.int64)
        _, first = np.unique(keys, axis=0, return_index=True)
        return cls(equations[first, :3], -equations[first, 3])

    @classmethod
    def from_box(cls, box: Box) -> "Polytope":
        """Return a box as a polytope of six faces."""
        normals = np.concatenate([np.eye(3), -np.eye(3)])
        return cls(normals, np.concatenate([np.asarray(box.high), -np.asarray(box.low)]))

    def contains(
        self, points: Float[np.ndarray, "*batch 3"], tolerance: float = 1e-9
    ) -> Bool[np.ndarray, "*batch"]:
        """Return which points lie inside, or outside every face by at most `tolerance` [m]."""
        return np.all(points @ self.normals.T <= self.offsets + tolerance, axis=-1)

    def z_interval(
        self, points_xy: Float[np.ndarray, "P 2"]
    ) -> tuple[Float[np.ndarray, " P"], Float[np.ndarray, " P"]]:
        """Intersect the vertical line through each point with the polytope.

        Args:
            points_xy: horizontal positions of the lines [m].

        Returns:
            The lowest and the highest z [m] of each line inside the polytope; both NaN where the
            line misses it.
        """
        slack = self.offsets - points_xy @ self.normals[:, :2].T
        slope = self.normals[:, 2]
        up, down, upright = slope > 1e-12, slope < -1e-12, np.abs(slope) <= 1e-12
        high = np.min(slack[:, up] / slope[up], axis=1, initial=np.inf)
        low = np.max(slack[:, down] / slope[down], axis=1, initial=-np.inf)
        missed = (low > high) | np.any(slack[:, upright] < 0, axis=1)
        return np.where(missed, np.nan, low), np.where(missed, np.nan, high)

    def cut(
        self, normals: Float[np.ndarray, "G 3"], offsets: Float[np.ndarray, " G"]
    ) -> "Polytope":
        """Return the part of the polytope inside further half-spaces; it may be empty."""
        return Polytope(
            np.concatenate([self.normals, normals]), np.concatenate([self.offsets, offsets])
        )

    def mirrored(self) -> "Polytope":
        """Return the mirror image in the plane y = 0, which swaps left and right limbs."""
        return Polytope(self.normals * np.array([1.0, -1.0, 1.0]), self.offsets)

    @cached_property
    def vertices(self) -> Float[np.ndarray, "V 3"]:
        """The corners, each once [m].

        Raises:
            InputError: the polytope is empty, flat or unbounded.
        """
        halfspaces = np.concatenate([self.normals, -self.offsets[:, None]], axis=1)
        try:
            corners = HalfspaceIntersection(halfspaces, self._centre()).intersections
        except QhullError as error:
            raise InputError("this polytope has no corners: it is unbounded or flat") from error
        if not np.isfinite(corners).all():
            raise InputError("this polytope is unbounded")
        _, first = np.unique(np.round(corners, 8), axis=0, return_index=True)
        return corners[np.sort(first)]

    @cached_property
    def edges(self) -> Float[np.ndarray, "E 2 3"]:
        """The edges as pairs of end points [m]: corners that share at least two faces."""
        corners = self.vertices
        on_face = np.abs(corners @ self.normals.T - self.offsets) < _ON_FACE
        shared = on_face.astype(int) @ on_face.T.astype(int)
        first, second = np.nonzero(np.triu(shared >= 2, k=1))
        return np.stack([corners[first], corners[second]], axis=1)

    @property
    def bounds(self) -> Box:
        """The smallest axis-aligned box around the polytope."""
        low, high = self.vertices.min(axis=0), self.vertices.max(axis=0)
        return Box((low[0], low[1], low[2]), (high[0], high[1], high[2]))

    def _centre(self) -> Float[np.ndarray, " 3"]:
        # Chebyshev's centre: the middle of the largest ball inside.
        faces = np.concatenate([self.normals, np.ones((len(self.offsets), 1))], axis=1)
        answer = linprog(
            [0, 0, 0, -1], A_ub=faces, b_ub=self.offsets, bounds=[(None, None)] * 3 + [(0, 1e3)]
        )
        if answer.status != 0 or answer.x[3] < 1e-9:
            raise InputError("this polytope is empty or flat")
        return answer.x[:3]
