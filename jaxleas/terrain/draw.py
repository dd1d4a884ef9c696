"""Pictures of height maps in the style of T figures 3.14-3.17: higher ground is brighter."""

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float

from jaxleas.files import atomic_path
from jaxleas.terrain.height_map import HeightMap
from jaxleas.types import InputError, is_ground

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.colors import Colormap, Normalize

VOID_COLOUR = "#c9d7e8"
DARK, BRIGHT = 0.16, 0.97
"""Grey of the lowest and of the highest ground."""
RELIEF = 0.10
"""Amount by which a slope of 1 towards or away from the light brightens or darkens."""
MOST_PIXELS = 1600
"""Largest side of a map that is drawn whole [cells]; larger maps are thinned first."""
LARGEST_SIDE = 10.0
"""Size of a figure that this module makes [inches]."""


def draw_height_map(
    height_map: HeightMap,
    path: str | Path | None = None,
    ax: "Axes | None" = None,
    title: str | None = None,
    colour_bar: bool = True,
) -> "Axes":
    """Draw a height map and return the axes, for paths to be drawn over it.

    Args:
        height_map: height map to draw.
        path: file for the picture (.png, .svg, .pdf); None: it is not written.
        ax: axes to draw on; new ones by default.
        title: title above the picture.
        colour_bar: whether to draw the scale of heights.

    Raises:
        InputError: the picture cannot be written, or is of an unknown type.
    """
    ax = _new_axes(height_map) if ax is None else ax
    scale, greys = _scale(height_map.heights)
    step = [-(-cells // MOST_PIXELS) for cells in height_map.shape]
    spacing = (height_map.resolution * step[0], height_map.resolution * step[1])
    ax.imshow(
        _shaded(height_map.heights[:: step[0], :: step[1]], spacing, scale, greys),
        origin="lower",
        extent=height_map.extent,
        interpolation="nearest",
    )
    # beyond the map there is no ground either
    ax.set(xlabel="x [m]", ylabel="y [m]", aspect="equal", facecolor=VOID_COLOUR)
    if title:
        ax.set_title(title)
    if colour_bar:
        _draw_colour_bar(ax, height_map, scale, greys)
    if path is not None:
        save_picture(ax, Path(path))
    return ax


def _new_axes(height_map: HeightMap) -> "Axes":
    from matplotlib.figure import Figure  # not pyplot: no global state, no window, no backend

    rows, columns = height_map.shape
    side = LARGEST_SIDE / max(rows, columns)
    size = (max(4.0, columns * side) + 1.2, max(2.2, rows * side) + 0.8)
    return Figure(figsize=size, layout="constrained").subplots()


def _scale(heights: Float[np.ndarray, "R C"]) -> "tuple[Normalize, Colormap]":
    """Return the grey scale; a few tall boxes exceed it, so that they do not darken the ground."""
    from matplotlib.colors import LinearSegmentedColormap, Normalize

    ground = heights[np.isfinite(heights)]
    if not ground.size:
        ground = np.zeros(1)
    low, high = float(ground.min()), float(np.percentile(ground, 97.0))
    middle, half = 0.5 * (low + high), max(0.5 * (high - low), 0.1)
    greys = LinearSegmentedColormap.from_list("heights", [str(DARK), str(BRIGHT)])
    return Normalize(middle - half, middle + half, clip=True), greys


def _shaded(
    heights: Float[np.ndarray, "R C"],
    spacing: tuple[float, float],
    scale: "Normalize",
    greys: "Colormap",
) -> Float[np.ndarray, "R C 3"]:
    from matplotlib.colors import to_rgb

    void = ~is_ground(heights)
    filled = np.where(void, 0.0, heights)
    pixels = greys(scale(filled))[..., :3]
    along_y, along_x = np.gradient(filled, *spacing)
    # light from the upper left; a cell next to the void has no meaningful slope
    light = np.clip((along_x - along_y) / np.sqrt(2.0), -1.0, 1.0)
    beside = np.zeros_like(void)
    beside[1:] |= void[:-1]
    beside[:-1] |= void[1:]
    beside[:, 1:] |= void[:, :-1]
    beside[:, :-1] |= void[:, 1:]
    pixels = np.clip(pixels + RELIEF * np.where(beside, 0.0, light)[..., None], 0.0, 1.0)
    pixels[void] = to_rgb(VOID_COLOUR)
    return pixels


def _draw_colour_bar(
    ax: "Axes", height_map: HeightMap, scale: "Normalize", greys: "Colormap"
) -> None:
    from matplotlib.cm import ScalarMappable
    from matplotlib.patches import Patch

    figure = ax.get_figure()
    assert figure is not None
    rows, columns = height_map.shape
    figure.colorbar(
        ScalarMappable(scale, greys),
        ax=ax,
        label="height [m]",
        shrink=min(1.0, max(0.5, rows / columns)),
        extend="max" if np.nanmax(height_map.heights) > (scale.vmax or 0.0) else "neither",
        extendfrac=0.02,
    )
    if height_map.void_fraction > 0.0:
        patch = Patch(facecolor=VOID_COLOUR, edgecolor="0.4", label="no ground")
        ax.legend(handles=[patch], loc="upper right", fontsize="small", framealpha=0.9)


def require_picture(path: str | Path) -> None:
    """Refuse the name of a picture whose type cannot be drawn."""
    if Path(path).suffix.lower() not in (".png", ".svg", ".pdf"):
        raise InputError(f"{path}: pictures are .png, .svg or .pdf, not '{Path(path).suffix}'")


def save_picture(ax: "Axes", path: Path) -> None:
    """Write the picture that axes are part of, whole or not at all.

    Raises:
        InputError: the picture cannot be written, or is of an unknown type.
    """
    figure = ax.get_figure(root=True)
    assert figure is not None
    require_picture(path)
    with atomic_path(path) as temporary:
        figure.savefig(temporary, dpi=110)
