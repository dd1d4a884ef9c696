"""The terrains of a run: those trained on, and those held out for the examination."""

from jaxleas.envs.steering.world import World, make_world
from jaxleas.terrain.generator import generate_arena
from jaxleas.terrain.seeds import HELD_OUT_SEED, MAX_TRAINING_SEED
from jaxleas.training.config import RunConfig
from jaxleas.types import InputError

NOT_CROSSED = ("flat", "obstacles", "cliff", "void")


def training_world(config: RunConfig) -> World:
    """Generate the arenas to train on.

    Raises:
        InputError: their seeds would leave the training range, or no arena has a link.
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
    return make_world(arenas, terrain.resolution, terrain.shares.model_dump())


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
