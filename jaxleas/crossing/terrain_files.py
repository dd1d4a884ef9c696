"""Terrain files as the polygons that physics needs."""

from dataclasses import replace
from pathlib import Path

from jaxleas.terrain import Reading, Scene, has_polygons, load_scene


def scene_of(terrain: Path, reading: Reading) -> Scene:
    """Return a terrain as polygons; cells that are stated are those of the robot's map alone.

    Args:
        terrain: file of the terrain.
        reading: what the file does not state itself.
    """
    if has_polygons(terrain):
        reading = replace(reading, resolution=None)
    return load_scene(terrain, reading)
