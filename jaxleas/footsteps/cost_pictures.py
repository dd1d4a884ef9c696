"""Figure 4.9 of the thesis: a map as it is measured, filtered, and where feet may land."""

from pathlib import Path

import numpy as np

from jaxleas.files import atomic_path
from jaxleas.footsteps.cost_map import FootCostMap
from jaxleas.terrain import VOID_COLOUR, HeightMap, draw_height_map, require_picture

EDGE, BUFFER, SAFE = "#7a0019", "#e2725b", "#2f2f2f"


def draw_cost_map(raw: HeightMap, costs: FootCostMap, path: Path) -> None:
    """Draw a height map, the filtered one and its foot cost map, one below the other.

    Args:
        raw: map as it was measured.
        costs: foot cost map of it.
        path: file for the picture.

    Raises:
        InputError: the picture cannot be written, or is of an unknown type.
    """
    import matplotlib as mpl
    from matplotlib.colors import BoundaryNorm, ListedColormap
    from matplotlib.figure import Figure
    from matplotlib.patches import Patch

    require_picture(path)
    ground = ~np.isnan(costs.height_map.heights)
    kind = np.select([~ground, costs.distance <= 0, ~costs.safe], [0, 1, 2], default=3)
    names = ("no ground", "edge", f"within {100 * costs.buffer:.1f} cm", "safe")
    colours = (VOID_COLOUR, EDGE, BUFFER, SAFE)
    x_min, x_max, y_min, y_max = raw.extent
    height = 3 * (y_max - y_min) / (x_max - x_min) * 8 + 2
    with mpl.rc_context({"font.size": 9}):
        figure = Figure(figsize=(9, float(np.clip(height, 5, 24))), layout="constrained")
        above, middle, below = figure.subplots(3, 1, sharex=True)
        draw_height_map(raw, ax=above, title="as measured")
        draw_height_map(costs.height_map, ax=middle, title="filtered")
        below.imshow(
            kind,
            origin="lower",
            extent=(x_min, x_max, y_min, y_max),
            cmap=ListedColormap(colours),
            norm=BoundaryNorm(np.arange(5) - 0.5, 4),
            interpolation="nearest",
        )
        below.set(title="where feet may land", xlabel="x [m]", ylabel="y [m]")
        patches = [
            Patch(color=colour, label=name) for colour, name in zip(colours, names, strict=True)
        ]
        below.legend(handles=patches, loc="upper right", fontsize=7)
        with atomic_path(path) as temporary:
            figure.savefig(temporary, format=path.suffix[1:] or "png", dpi=120)
