"""Picture of the surfaces found in a height map, over the map."""

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from jaxleas.terrain.draw import draw_height_map, save_picture
from jaxleas.terrain.height_map import HeightMap
from jaxleas.terrain.planes.found import Cell, FoundSurfaces

if TYPE_CHECKING:
    from matplotlib.axes import Axes

LEFT_OVER = {
    Cell.STEEP: ("too steep", "#c0392b"),
    Cell.ROUGH: ("too rough", "#e59866"),
    Cell.SMALL: ("too small", "#af7ac5"),
}
"""Name and colour of cells that are no surface."""


def draw_surfaces(height_map: HeightMap, found: FoundSurfaces, path: str | Path) -> None:
    """Draw surfaces over their height map, one hue each, and the cells that were left over.

    Args:
        height_map: height map that was searched.
        found: what was found in it.
        path: file for the picture (.png, .svg, .pdf).

    Raises:
        InputError: the picture cannot be written, or is of an unknown type.
    """
    ax = draw_height_map(height_map, title=f"{len(found.fit)} surfaces")
    _paint_left_over(ax, height_map, found)
    _draw_polygons(ax, found)
    save_picture(ax, Path(path))


def _paint_left_over(ax: "Axes", height_map: HeightMap, found: FoundSurfaces) -> None:
    from matplotlib.colors import to_rgba
    from matplotlib.patches import Patch

    pixels = np.zeros((*height_map.shape, 4))
    handles = []
    for kind, (name, colour) in LEFT_OVER.items():
        cells = found.cells == kind
        if cells.any():
            pixels[cells] = to_rgba(colour)
            handles.append(Patch(facecolor=colour, label=name))
    ax.imshow(pixels, origin="lower", extent=height_map.extent, interpolation="nearest")
    if handles:
        ax.legend(handles=handles, loc="upper right", fontsize="small", framealpha=0.9)


def _draw_polygons(ax: "Axes", found: FoundSurfaces) -> None:
    from matplotlib.collections import PolyCollection

    corners = [each[:, :2] for each in found.polygons.values()]
    hues = [surface_colour(found.surface_of(name)) for name in found.polygons]
    ax.add_collection(
        PolyCollection(corners, facecolors=[(*hue, 0.45) for hue in hues], edgecolors=hues)
    )


def surface_colour(number: int) -> tuple[float, float, float]:
    """Return the colour of a surface: no red, and neighbouring numbers differ much."""
    from colorsys import hsv_to_rgb

    return hsv_to_rgb(0.1 + 0.75 * ((number * 0.618034) % 1.0), 0.75, 0.85)
