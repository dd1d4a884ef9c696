"""The terrain of the steering task: links between tiles, and the user's own files."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from jaxleas.configuration import Fraction, NonNegative, Strict
from jaxleas.envs import WorldsConfig
from jaxleas.terrain import Entry as TerrainEntry
from jaxleas.terrain import GeneratorConfig, NoiseConfig
from jaxleas.terrain import pinned as pinned_files


class LinkShares(Strict):
    """Relative frequencies at which an episode begins at a link of each kind.

    Drawn uniformly, half of the links would be level ground, and one in ten a narrow bridge, which
    takes the longest to learn.
    """

    bridge: NonNegative = 0.35
    stairs_up: NonNegative = 0.20
    stairs_down: NonNegative = 0.20
    rubble: NonNegative = 0.10
    obstacles: NonNegative = 0.12
    flat: NonNegative = 0.03
    detour: NonNegative = 0.0
    """Holes and walls to walk around (terrain.generator.detour_probability makes them)."""
    ledge: NonNegative = 0.0
    """Ledges up and down that the robot just can, or just cannot, cross
    (terrain.generator.limit_probability makes these and the next three)."""
    gap: NonNegative = 0.0
    """Gaps."""
    barrier: NonNegative = 0.0
    """Hurdles and walls."""
    posts: NonNegative = 0.0
    """Rows of posts."""
    cliff: NonNegative = 0.0
    """A goal too high up or too far down: stop. With a share of 0.1 policies also stopped before
    stairs; random goals teach enough of stopping."""
    void: NonNegative = 0.0
    """A goal where there is no ground: stop; the same holds for its share."""


class TerrainConfig(WorldsConfig):
    """The terrain that robots train on."""

    resolution: Annotated[float, Field(ge=0.01, le=0.2)] = 0.04
    """Side of a height map's cell [m]."""
    shares: LinkShares = LinkShares()
    generator: GeneratorConfig = GeneratorConfig()
    examined: Literal["crossings", "all"] = "crossings"
    """Links at which the examination's starts begin: those that can be crossed, and the policy that
    crosses most is kept; or dead ends and limits, too, where staying valid is success: kinds with a
    share are then equally frequent, and the policy is kept whose worst kind is best."""
    spare: Annotated[float, Field(ge=0.0, le=0.08)] = 0.0
    """Room that a valid configuration leaves in training and its examination [m]: the trunk counts
    as this much larger to each side, and the square under the root as this much smaller. A policy
    so keeps valid where polygons are asked, not a map with cells of some centimetres."""
    noise: NoiseConfig = NoiseConfig()
    files: tuple[TerrainEntry, ...] = ()
    """The user's own terrain files to train on besides the generator's arenas: paths, or
    `{file: PATH, up: y, scale: 0.001}` with what a file does not state itself. They are used for
    training, never for evaluation."""
    files_share: Fraction = 0.0
    """Share of the starts that fall on these files, divided evenly among them."""

    @model_validator(mode="after")
    def _files_have_a_share(self) -> Self:
        if self.files and not self.files_share:
            raise ValueError("files are given, but files_share is 0: give a share, such as 0.5")
        if self.files_share and not self.files:
            raise ValueError(
                f"files_share is {self.files_share:g}, but no files are given: give files, too"
            )
        return self

    def pinned(self) -> Self:
        """Return the same terrain, with the absolute path and digest of each file."""
        return self.model_copy(update={"files": pinned_files(self.files)})

    def without_files(self) -> Self:
        """Return the same terrain without the files: arenas alone, which have surfaces."""
        return self.model_copy(update={"files": (), "files_share": 0.0})
