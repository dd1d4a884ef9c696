"""The terrains of a run: those trained on, and those held out for the examination."""

from jaxleas.envs.steering.own_terrain import make_own_terrain
from jaxleas.envs.steering.world import OwnMaps, World, make_world
from jaxleas.robots import load_robot
from jaxleas.terrain.generator import generate_arena
from jaxleas.terrain.own_files import read_own_terrain
from jaxleas.terrain.seeds import HELD_OUT_SEED, MAX_TRAINING_SEED
from jaxleas.training.config import RunConfig
from jaxleas.types import InputError

NOT_CROSSED = ("flat", "obstacles", "cliff", "void")


def training_world(config: RunConfig) -> World:
    """Generate the arenas to train on, and read the terrain files.

    Raises:
        InputError: their seeds would leave the training range, no arena has a link, or a file
            cannot be trained on.
    """
    terrain = config.terrain
    last = terrain.first_seed + terrain.arenas - 1
    if last > MAX_TRAINING_SEED:
        raise InputError(
            f"terrain.first_seed + terrain.arenas reaches seed {last}, but seeds above"
            f" {MAX_TRAINING_SEED} are kept for evaluation: give a smaller first_seed"
        )
    arenas = [
        generate_arena(terrain.generator, seed) for seed in range(terrain.first_seed, last + 1)
    ]
    return make_world(arenas, terrain.resolution, terrain.shares.model_dump(), own_maps(config))


def without_files(config: RunConfig) -> RunConfig:
    """Return the configuration without its terrain files: on arenas alone, which have surfaces."""
    terrain = config.terrain.model_copy(update={"files": (), "files_share": 0.0})
    return config.model_copy(update={"terrain": terrain})


def require_own_terrain(config: RunConfig) -> None:
    """Refuse terrain files that cannot be trained on, before a run folder is made.

    Raises:
        InputError: one sentence with file and key.
    """
    files = own_maps(config)
    if files is not None:
        make_own_terrain(files.robot, files.maps, files.share, first_map=0)


def own_maps(config: RunConfig) -> OwnMaps | None:
    """Read the terrain files of a configuration; None: it names none."""
    terrain = config.terrain
    if not terrain.files:
        return None
    maps = read_own_terrain(terrain.files, terrain.resolution)
    return OwnMaps(maps, terrain.files_share, load_robot(config.env.robot))


def held_out_world(config: RunConfig) -> World:
    """Generate the arenas of the examination: the same generator, seeds never trained on.

    Without boxes, and with crossings only: every goal can be reached, so the score has room to the
    top and the best policy can be told from the second best.
    """
    terrain = config.terrain
    clear = terrain.generator.obstacles.model_copy(update={"probability": 0.0})
    generator = terrain.generator.model_copy(update={"obstacles": clear})
    crossings = terrain.shares.model_dump() | dict.fromkeys(NOT_CROSSED, 0.0)
    seeds = range(HELD_OUT_SEED, HELD_OUT_SEED + config.held_out.arenas)
    arenas = [generate_arena(generator, seed) for seed in seeds]
    return make_world(arenas, terrain.resolution, crossings)
