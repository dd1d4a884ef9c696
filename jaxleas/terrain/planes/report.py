"""What was found in a map and what was left over, in words."""

from pathlib import Path

from jaxleas.terrain.planes.found import Cell, FoundSurfaces
from jaxleas.terrain.planes.rises import LEAST
from jaxleas.types import InputError

NAMES = {
    Cell.VOID: "void",
    Cell.STEEP: "too steep",
    Cell.ROUGH: "too rough",
    Cell.SMALL: "too small",
}


def surfaces_in_words(found: FoundSurfaces) -> str:
    """Return number, area and fit of surfaces, and the shares of cells left over, in one line."""
    count, parts = len(found.fit), len(found.polygons)
    what, them = ("1 surface", "it") if count == 1 else (f"{count} surfaces", "them")
    cut = f" in {parts} convex polygons" if parts > count else ""
    return (
        f"{what}{cut}, {found.area:.2f} m2, found in the map; their cells lie"
        f" {1000.0 * found.root_mean_square:.1f} mm off {them} (RMS);"
        f" {_left_over(found)}{_passable(found)}"
    )


def require_surfaces(path: str | Path, found: FoundSurfaces) -> None:
    """Refuse a map in which no surface was found.

    Raises:
        InputError: no surface was found; the message says what its cells are instead.
    """
    if found.polygons:
        return
    raise InputError(
        f"{path}: no surface was found in the map: {_left_over(found)}; --roughness, --max-slope"
        " and --min-area say what counts as a surface"
    )


def _left_over(found: FoundSurfaces) -> str:
    shares = found.shares
    named = [
        f"{100.0 * shares[kind]:.1f} % {name}" for kind, name in NAMES.items() if shares[kind] > 0.0
    ]
    if not named:
        return "no cell is left over"
    total = 100.0 * (1.0 - shares[Cell.SURFACE])
    return f"left over are {total:.1f} % of the cells: {', '.join(named)}"


def _passable(found: FoundSurfaces) -> str:
    """Return what of the ground is an obstacle, and how much is neither that nor surface."""
    faces = len(found.obstacles)
    high = f"; rises of {LEAST:g} m and more are obstacles, {faces} upright faces" if faces else ""
    shares = found.shares
    ground = (1.0 - shares[Cell.SURFACE] - shares[Cell.VOID]) * found.cells.size
    if ground < 0.5:
        return high
    return f"{high}; those {ground * found.resolution**2:.2f} m2 of ground are no obstacles" + (
        " besides" if faces else ""
    )
