"""The meshes that a URDF names: where they are found, and which are missed."""

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from jaxtyping import Float
from scipy.spatial import ConvexHull, QhullError

from jaxleas.modelling.collada import read_collada
from jaxleas.terrain import MESHES
from jaxleas.types import InputError

_READ = (".stl", ".obj", ".ply", ".off")


@dataclass
class MeshSearch:
    """Where a URDF's meshes are looked for, and which were missed.

    Attributes:
        urdf: URDF file.
        packages: folders of packages that its addresses name.
        missed: meshes that were not found or not read, each with the reason.
    """

    urdf: Path
    packages: tuple[Path, ...] = ()
    missed: dict[str, str] = field(default_factory=dict)

    def points(self, address: str) -> Float[np.ndarray, "P 3"] | None:
        """Return the corners of the convex hull of a mesh in its own units; None if missed."""
        path = self._found(address)
        if path is None:
            self.missed[address] = "it is not at hand"
            return None
        suffix = path.suffix.lower()
        if suffix not in (*_READ, ".dae"):
            self.missed[address] = f"{path.suffix} files are not read"
            return None
        try:
            if suffix == ".dae":
                corners = read_collada(path)
            else:
                corners = MESHES[suffix].read(path).corners.reshape(-1, 3)
        except InputError as error:
            self.missed[address] = str(error)
            return None
        if not (len(corners) and np.isfinite(corners).all()):
            self.missed[address] = "it has no faces, or places that are not finite"
            return None
        return hull_corners(corners)

    def _found(self, address: str) -> Path | None:
        """Return the file that an address names, looked for beside the URDF and above it."""
        scheme, found, rest = address.partition("://")
        if not found:
            path = self.urdf.parent / address
            return path if path.is_file() else None
        if scheme == "file":
            return Path(rest) if Path(rest).is_file() else None
        package, _, inner = rest.partition("/")
        above = self.urdf.absolute().parents
        tried = [
            *(folder / inner for folder in self.packages),
            *(folder / rest for folder in (*self.packages, *above)),
            *(folder / inner for folder in above if folder.name == package),
            # where a package was taken out of its workspace under another name
            *(folder / inner for folder in above[:3]),
        ]
        return next((path for path in tried if path.is_file()), None)


def hull_corners(points: Float[np.ndarray, "P 3"]) -> Float[np.ndarray, "Q 3"]:
    """Return the corners of the convex hull of points; all points where they span no volume."""
    if len(points) < 5:
        return points
    try:
        return points[ConvexHull(points).vertices]
    except QhullError:
        return points
