"""Palms: where hands reach, with joints that limbs have in common held in the reference stance."""

from collections.abc import Mapping

import numpy as np

from jaxleas.modelling.hulls import simple_hull
from jaxleas.modelling.options import MakeOptions
from jaxleas.modelling.sampling import CHUNK, place_soles
from jaxleas.modelling.tree import UrdfTree
from jaxleas.robots import Effector, Limb, chain_between, chain_posture

_DRAWN = CHUNK


def make_palms(
    tree: UrdfTree, root: str, angles: Mapping[str, float], options: MakeOptions
) -> tuple[Limb, ...]:
    """Return a limb for each hand: its range of motion is the hull of where its frame can be.

    Its joints are not part of the robot's file, and its mass counts with the body.

    Args:
        tree: links of the robot.
        root: name of the root.
        angles: angles of the reference stance, by joint [rad].
        options: choices for the robot.

    Raises:
        InputError: a hand does not move.
    """
    paths = [{j.name for j in tree.path_to(link, root)} for link in (*options.feet, *options.hands)]
    found = []
    for link in options.hands:
        own = [joint.name for joint in tree.path_to(link, root)]
        held = {name: angles[name] for name in own if sum(name in path for path in paths) > 1}
        chain = chain_between(tree.path, tree.joints, (root, link), None, held)
        rng = np.random.default_rng(options.seed)
        drawn = rng.uniform(chain.lower, chain.upper, (min(options.samples, _DRAWN), len(chain)))
        places, _ = place_soles(chain, drawn)
        reference = chain_posture(chain, np.array([angles[name] for name in chain.names])).tip
        palm = Effector(link, "palm", options.palm_half_size, options.friction, None, link)
        reach = simple_hull(places, 2.0 * options.within, f"the range of motion of '{link}'")
        x, y, z = np.round(reference, 4).tolist()
        found.append(Limb(link, reach, palm, (x, y, z)))
    return tuple(found)
