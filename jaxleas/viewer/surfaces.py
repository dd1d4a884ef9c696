"""The surfaces found in a height map, drawn over it."""

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from jaxleas.terrain import (
    FoundSurfaces,
    HeightMap,
    PlaneSearch,
    find_surfaces,
    surface_colour,
    surfaces_in_words,
)
from jaxleas.viewer.ground import EDGE, EDGE_WIDTH
from jaxleas.viewer.painted import add_painted, joined, shade
from jaxleas.viewer.terrain_mesh import mesh_of_edges, mesh_of_polygons

if TYPE_CHECKING:
    from viser import ViserServer

MOST_SEARCHED = 4_000_000
"""Largest number of cells of a map in which surfaces are sought, in about 20 s."""
LIFTED = 0.004
"""Height of surfaces above the noise of the map that they were found in [m]."""


def show_surfaces(
    server: "ViserServer", terrain: Path, ground: HeightMap, search: PlaneSearch
) -> None:
    """Show the surfaces found in a map, and print what was left over.

    Args:
        server: server of the page.
        terrain: file of the map, for messages.
        ground: height map.
        search: what counts as a surface.
    """
    if ground.heights.size > MOST_SEARCHED:
        print(f"{terrain}: surfaces are not sought in a map of more than {MOST_SEARCHED} cells")
        return
    found = find_surfaces(ground, search)
    draw_surfaces_found(server, found)
    print(f"{terrain}: {surfaces_in_words(found)}", flush=True)


def draw_surfaces_found(server: "ViserServer", found: FoundSurfaces) -> None:
    """Draw the surfaces found in a map a little above it, one hue each, with their edges."""
    if not found.polygons:
        return
    above = np.array([0.0, 0.0, LIFTED + found.noise])
    lifted = {name: each + above for name, each in found.polygons.items()}
    parts = [mesh_of_polygons([each]) for each in lifted.values()]
    hues = [255.0 * np.array(surface_colour(found.surface_of(name))) for name in lifted]
    mesh = joined(parts)
    colours = np.repeat(hues, [len(each.vertices) for each in parts], axis=0)
    add_painted(server, "/surfaces", mesh, shade(mesh, colours))
    edges = mesh_of_edges(list(lifted.values()), EDGE_WIDTH)
    add_painted(server, "/edges", edges, np.tile(np.array(EDGE, float), (len(edges.vertices), 1)))
