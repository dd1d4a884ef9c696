"""The polygons of scenes as arrays: surfaces that feet stand on, obstacles for the legs."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int

from jaxleas.geometry import pack_polygons
from jaxleas.terrain import Scene, polygon_area_vector
from jaxleas.types import InputError


@dataclass(frozen=True, eq=False)
class Ground:
    """Convex polygons of one scene or several, surfaces first.

    Attributes:
        names: names of the polygons.
        scene: scene of each polygon: robots meet only the polygons of their own scene.
        walkable: number of surfaces; they come first among the polygons.
        vertices: vertices, padded by repeating the last one [m].
        normals: unit normals of the planes.
        offsets: offsets of the planes: n . x = offset [m].
        inward: unit normals of the edges in the polygon's plane; zero where padded.
        inward_offsets: x lies inside where inward . x >= inward_offset for all edges [m].
        low: lower corners of the bounding boxes [m].
        high: upper corners of the bounding boxes [m].
    """

    names: tuple[str, ...]
    scene: Int[np.ndarray, " P"]
    walkable: int
    vertices: Float[np.ndarray, "P W 3"]
    normals: Float[np.ndarray, "P 3"]
    offsets: Float[np.ndarray, " P"]
    inward: Float[np.ndarray, "P W 3"]
    inward_offsets: Float[np.ndarray, "P W"]
    low: Float[np.ndarray, "P 3"]
    high: Float[np.ndarray, "P 3"]

    def inside(
        self, points: Float[np.ndarray, "N 3"], polygon: Int[np.ndarray, " N"]
    ) -> Bool[np.ndarray, " N"]:
        """Return which points, seen along the normal of their polygon, lie inside it."""
        distance = (self.inward[polygon] @ points[:, :, None])[:, :, 0]
        return np.all(distance >= self.inward_offsets[polygon], axis=1)

    def heights_at(
        self, points_xy: Float[np.ndarray, "N 2"], scene: Int[np.ndarray, " N"]
    ) -> Float[np.ndarray, "N S"]:
        """Return the height of each surface over each point [m]; NaN outside, or in another scene.

        Args:
            points_xy: horizontal positions of the points in the world [m].
            scene: scene of each point.
        """
        count = self.walkable
        normals, offsets = self.normals[:count], self.offsets[:count]
        heights = (offsets - points_xy @ normals[:, :2].T) / normals[:, 2]
        points = np.concatenate(
            [np.broadcast_to(points_xy[:, None], (*heights.shape, 2)), heights[..., None]], axis=2
        )
        distance = np.einsum("swk,nsk->nsw", self.inward[:count], points)
        above = (distance >= self.inward_offsets[:count]).all(axis=2)
        above &= self.scene[:count] == scene[:, None]
        return np.where(above, heights, np.nan)


def ground_of(scenes: Sequence[Scene]) -> Ground:
    """Return the surfaces and obstacles of scenes as arrays; surfaces for palms alone block legs.

    Raises:
        InputError: a scene has no surface to stand on.
    """
    if not all(scene.walkable for scene in scenes):
        raise InputError("this scene has no surfaces for feet: nothing can stand anywhere")
    surfaces = [[*scene.walkable.items()] for scene in scenes]
    blocking = [
        [
            *((name, each) for name, each in scene.surfaces.items() if name not in scene.walkable),
            *scene.obstacles.items(),
        ]
        for scene in scenes
    ]
    groups = [*surfaces, *blocking]
    owner = np.repeat(np.tile(np.arange(len(scenes)), 2), [len(group) for group in groups])
    walkable = sum(len(group) for group in surfaces)
    return ground_from([each for group in groups for each in group], walkable, owner)


def ground_from(
    polygons: Iterable[tuple[str, np.ndarray]],
    walkable: int,
    scene: Int[np.ndarray, " P"] | None = None,
) -> Ground:
    """Return named polygons as arrays.

    Args:
        polygons: names and vertices.
        walkable: number of surfaces; they come first among the polygons.
        scene: scene of each polygon; all of scene 0 if None.
    """
    named = list(polygons)
    vertices = pack_polygons([polygon for _, polygon in named])
    areas = np.array([polygon_area_vector(np.asarray(polygon)) for _, polygon in named])
    normals = areas / np.linalg.norm(areas, axis=1, keepdims=True)
    edges = np.roll(vertices, -1, axis=1) - vertices
    inward = np.cross(normals[:, None], edges)
    length = np.linalg.norm(inward, axis=2, keepdims=True)
    inward = np.where(length > 1e-9, inward / np.maximum(length, 1e-9), 0.0)
    return Ground(
        names=tuple(name for name, _ in named),
        scene=np.zeros(len(named), dtype=np.int64) if scene is None else scene,
        walkable=walkable,
        vertices=vertices,
        normals=normals,
        offsets=(normals * vertices[:, 0]).sum(axis=1),
        inward=inward,
        inward_offsets=(inward * vertices).sum(axis=2),
        low=vertices.min(axis=1),
        high=vertices.max(axis=1),
    )
