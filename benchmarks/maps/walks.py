"""Guide paths of the shipped policy over terrain it never saw."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from jaxleas.envs.steering import SteeringEnv
from jaxleas.evaluation import make_suite
from jaxleas.evaluation.contender import contender
from jaxleas.evaluation.starts import draw_starts, make_grounds
from jaxleas.guide import LEAS, load_policy
from jaxleas.terrain import Scene
from jaxleas.types import GuidePath

POLICY = Path(__file__).resolve().parents[2] / "pretrained/leas_p1.npz"
KINDS = {"stairs": ("stairs_up", "stairs_down"), "rubble": ("rubble",)}


@dataclass(frozen=True)
class Walk:
    """A guide path that reached its goal, and the terrain that it crosses.

    Attributes:
        scene: the terrain.
        number: number of the terrain among those of its kind.
        path: guide path.
    """

    scene: Scene
    number: int
    path: GuidePath


def walks(kind: str, count: int, held_out: bool) -> list[Walk]:
    """Return guide paths over terrain of a kind, ten over each, as in the suite footsteps.

    Args:
        kind: stairs (half of them up, half down) or rubble.
        count: number of starts.
        held_out: whether the terrain is that for choosing and tuning.
    """
    policy = load_policy(POLICY)
    env = SteeringEnv(policy.config.under_standard_conditions())
    names = KINDS[kind]
    suite = make_suite("footsteps", count // len(names), held_out=held_out)
    cells = [each for each in suite.cells if each.name in names]
    grounds = make_grounds(cells)
    found = []
    for offset, cell in enumerate(cells):
        starts = draw_starts(env, grounds, cell, suite.stream())
        walk = contender(env, LEAS.make(env, policy))(grounds, starts, suite.steps_of(cell))
        for index in np.flatnonzero(walk.reached).tolist():
            number = int(starts.scene[index])
            path = walk.guide_path(index, env.config.limits.time_step)
            scene = cell.scenarios[number].scene
            found.append(Walk(scene, number + offset * len(cell.scenarios), path))
    return found
