"""Terrain: scenes of convex surfaces, height maps, random arenas, named scenes, importers."""

from jaxleas.terrain.config import GeneratorConfig
from jaxleas.terrain.draw import draw_height_map
from jaxleas.terrain.generator import Arena, generate_arena
from jaxleas.terrain.height_map import HeightMap, read_height_map, write_height_map
from jaxleas.terrain.importers import import_mesh, import_png, import_terrain
from jaxleas.terrain.links import Link, Tile
from jaxleas.terrain.mesh_scene import load_scene, mesh_to_scene
from jaxleas.terrain.rasterise import rasterise
from jaxleas.terrain.scenarios import (
    SCENARIOS,
    Scenario,
    circuit,
    dead_end,
    hole,
    long_course,
    make_scenario,
    rotation,
    scene_with_areas,
    transition,
    wall,
)
from jaxleas.terrain.scene import Scene, read_scene, write_scene
from jaxleas.terrain.tiles import TileKind

__all__ = [
    "SCENARIOS",
    "Arena",
    "GeneratorConfig",
    "HeightMap",
    "Link",
    "Scenario",
    "Scene",
    "Tile",
    "TileKind",
    "circuit",
    "dead_end",
    "draw_height_map",
    "generate_arena",
    "hole",
    "import_mesh",
    "import_png",
    "import_terrain",
    "load_scene",
    "long_course",
    "make_scenario",
    "mesh_to_scene",
    "rasterise",
    "read_height_map",
    "read_scene",
    "rotation",
    "scene_with_areas",
    "transition",
    "wall",
    "write_height_map",
    "write_scene",
]
