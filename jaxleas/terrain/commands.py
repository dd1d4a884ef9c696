"""The functions behind `jaxleas terrain show`, `import`, `surfaces`, `generate`, `scenario`."""

from pathlib import Path

import numpy as np
from pydantic import ValidationError

from jaxleas.robots import DEFAULT_ROBOT, load_robot
from jaxleas.terrain.config import GeneratorConfig
from jaxleas.terrain.draw import draw_height_map, require_picture
from jaxleas.terrain.generator import generate_arena
from jaxleas.terrain.height_map import HeightMap
from jaxleas.terrain.importers import import_terrain
from jaxleas.terrain.loading import has_polygons, is_map, scene_of_surfaces
from jaxleas.terrain.planes.finding import find_surfaces
from jaxleas.terrain.planes.picture import draw_surfaces
from jaxleas.terrain.planes.report import require_surfaces, surfaces_in_words
from jaxleas.terrain.planes.settings import PLANE_SEARCH, PlaneSearch
from jaxleas.terrain.reading import READING, SHAPING, Reading, require_applicable
from jaxleas.terrain.scale import scale_for, scaled
from jaxleas.terrain.scenarios import make_scenario, scene_with_areas
from jaxleas.terrain.scene_file import write_scene
from jaxleas.terrain.shaping import holes
from jaxleas.terrain.writers.catalogue import FormatName, named_by_format, written_as
from jaxleas.types import InputError


def show(
    file: Path,
    *,
    out: Path | None = None,
    reading: Reading = READING,
) -> Path:
    """Draw a terrain file from above, and print its size.

    Args:
        file: height map, scene, mesh, image, table or bag; docs/files.md lists all kinds.
        out: file of the picture; by default NAME_view.png in the current folder.
        reading: what the file does not state itself.
    """
    picture = Path(f"{file.stem}_view.png") if out is None else out
    if picture.resolve() == file.resolve():
        raise InputError(f"--out {picture} is the terrain itself: give the picture another name")
    height_map = import_terrain(file, reading)
    draw_height_map(height_map, picture, title=file.name)
    print(f"{file}: {describe(height_map)}\ndrawn in {picture}")
    return picture


def convert(
    file: Path,
    *,
    out: Path | None = None,
    format: FormatName | None = None,
    reading: Reading = READING,
) -> Path:
    """Write a terrain as a file of another kind: height map, scene, STL, image, GeoTIFF or bag.

    Args:
        file: height map, scene, mesh, image, table or bag; docs/files.md lists all kinds.
        out: file to write: .npz, .json, .stl, .xml (MJCF), .png, .tif, .asc, .bag, .mcap, or a name
            without suffix for the folder of a ROS 2 bag; by default FILE with the suffix of
            --format, in the current folder.
        format: kind of file; by default that of the name of --out.
        reading: what the file does not state itself.

    Raises:
        InputError: the terrain cannot be read, or not be written so; neither --out nor --format
            is given, or they disagree.
    """
    out = named_by_format(file, out, format)
    form = written_as(out)
    if form.polygons is not None and (form.map is None or _stays_polygons(file, reading)):
        if has_polygons(file):
            _require_no_map(file, reading)
        print(f"{file}: {form.polygons(out, file, reading)}\nwritten to {out}")
        return out
    assert form.map is not None
    height_map = import_terrain(file, reading)
    written = form.map(out, height_map)
    print(f"{file}: {describe(height_map)}\nwritten to {out}: {written}")
    return out


def surfaces(
    file: Path,
    *,
    out: Path | None = None,
    picture: Path | None = None,
    reading: Reading = READING,
    search: PlaneSearch = PLANE_SEARCH,
) -> None:
    """Find the planar surfaces of a height map, and write them as a scene (.json).

    Args:
        file: height map, image, table or bag; docs/files.md lists all kinds.
        out: file of the scene, .json; by default only what is found is printed.
        picture: draw the surfaces, and the cells left over, over the map (.png, .svg, .pdf).
        reading: what the file does not state itself.
        search: what counts as a surface.
    """
    if out is not None:
        _require_suffix(out, ".json")
    if picture is not None:
        require_picture(picture)
    if not is_map(file):
        raise InputError(
            f"{file} is no map of heights: a scene or a mesh states its surfaces itself"
        )
    height_map = import_terrain(file, reading)
    found = find_surfaces(height_map, search)
    if picture is not None:  # also where nothing is found: it shows why
        draw_surfaces(height_map, found, picture)
    require_surfaces(file, found)
    print(f"{file}: {surfaces_in_words(found)}")
    if out is not None:
        write_scene(out, scene_of_surfaces(found))
        print(f"written to {out}")


def generate(
    *, out: Path, seed: int = 0, rows: int = 5, columns: int = 5, robot: str = DEFAULT_ROBOT
) -> Path:
    """Generate a random arena of tiles as a scene (.json).

    Args:
        out: file of the scene, .json.
        seed: seed of the arena; the same seed gives the same arena.
        rows: number of tiles along y.
        columns: number of tiles along x.
        robot: robot that the tiles fit, by name or as the path of its .json; tiles for Talos are 2
            m long.
    """
    _require_suffix(out, ".json")
    if seed < 0:
        raise InputError(f"seed {seed} must not be negative")
    try:
        config = scaled(GeneratorConfig(rows=rows, columns=columns), scale_for(load_robot(robot)))
    except ValidationError as error:
        first = error.errors()[0]
        raise InputError(f"{first['loc'][0]} = {first['input']}: {first['msg']}") from error
    arena = generate_arena(config, seed)
    write_scene(out, arena.scene)
    kinds = sorted({link.kind for link in arena.links})
    print(
        f"{rows} x {columns} tiles, {len(arena.scene.surfaces)} surfaces, "
        f"{len(arena.links)} links ({', '.join(kinds) or 'none'})\nwritten to {out}"
    )
    return out


def scenario(name: str, *, out: Path, seed: int = 0, robot: str = DEFAULT_ROBOT) -> Path:
    """Write a named scenario as a scene (.json) with its start and goal areas.

    Args:
        name: name such as hole, stairs_up or long_course; a wrong name prints all of them.
        out: file of the scene, .json.
        seed: seed of the terrain; evaluation begins at 2000000.
        robot: robot whose leg the terrain fits: a name, or the path of its .json.
    """
    _require_suffix(out, ".json")
    if seed < 0:
        raise InputError(f"seed {seed} must not be negative")
    scene = scene_with_areas(make_scenario(name, seed, scale_for(load_robot(robot))))
    write_scene(out, scene)
    print(
        f"{name}, seed {seed}: {len(scene.surfaces)} surfaces, {len(scene.obstacles)} obstacle "
        f"faces, areas {', '.join(scene.areas)}\nwritten to {out}"
    )
    return out


def _stays_polygons(file: Path, reading: Reading) -> bool:
    """Tell whether a file holds polygons, and nothing is asked for that makes a map of them."""
    return has_polygons(file) and (reading.resolution, reading.fill, reading.smooth) == (None,) * 3


def _require_no_map(file: Path, reading: Reading) -> None:
    """Refuse what is done with a map alone, when a scene is to be written."""
    done = Reading(resolution=reading.resolution, fill=reading.fill, smooth=reading.smooth)
    require_applicable(file, done, (*SHAPING, "up", "scale"), "which is made a scene")


def describe(height_map: HeightMap) -> str:
    """Return a map's size, cells, heights, void and holes in one line."""
    x_min, x_max, y_min, y_max = height_map.extent
    rows, columns = height_map.shape
    low, high = np.nanmin(height_map.heights), np.nanmax(height_map.heights)
    low, high = (float(np.round(each, 2)) + 0.0 for each in (low, high))  # no -0.00
    region, inside = holes(height_map.heights)
    sizes = (
        np.bincount(region.reshape(-1), minlength=len(inside))[inside] * height_map.resolution**2
    )
    found = f"{len(sizes)} hole{'' if len(sizes) == 1 else 's'}" + (
        f" of up to {sizes.max():.2g} m2" if len(sizes) else ""
    )
    return (
        f"x {x_min:.2f} to {x_max:.2f} m, y {y_min:.2f} to {y_max:.2f} m, "
        f"{columns} x {rows} cells of {height_map.resolution:g} m, "
        f"heights {low:.2f} to {high:.2f} m, {100.0 * height_map.void_fraction:.1f} % void, "
        f"{found}"
    )


def _require_suffix(path: Path, suffix: str) -> None:
    if path.suffix.lower() != suffix:
        raise InputError(f"{path}: the name of this file must end in {suffix}")
