"""Terrain: scenes of convex surfaces, height maps, random arenas, named scenes, importers."""

from jaxleas.terrain.config import GeneratorConfig, TerrainConfig
from jaxleas.terrain.generator import Arena, generate_arena
from jaxleas.terrain.height_map import HeightMap, read_height_map, write_height_map
from jaxleas.terrain.links import Link, Tile
from jaxleas.terrain.rasterise import rasterise
from jaxleas.terrain.scene import Scene, read_scene, write_scene
from jaxleas.terrain.tiles import TileKind

__all__ = [
    "Arena",
    "GeneratorConfig",
    "HeightMap",
    "Link",
    "Scene",
    "TerrainConfig",
    "Tile",
    "TileKind",
    "generate_arena",
    "rasterise",
    "read_height_map",
    "read_scene",
    "write_height_map",
    "write_scene",
]
