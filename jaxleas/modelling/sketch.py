"""A robot before its kinematics are sampled: its legs, its stance, its masses, its trunk."""

import difflib
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float

from jaxleas.geometry import Box, Polytope
from jaxleas.modelling.feet import Say
from jaxleas.modelling.making_legs import Stance, make_stance
from jaxleas.modelling.masses import Masses, masses_of
from jaxleas.modelling.mesh_search import MeshSearch
from jaxleas.modelling.options import MakeOptions
from jaxleas.modelling.shapes import trunk_boxes
from jaxleas.modelling.tree import UrdfTree, read_tree
from jaxleas.robots import LimbModel
from jaxleas.types import InputError


@dataclass(frozen=True, eq=False)
class Sketch:
    """A robot before its kinematics are sampled.

    Attributes:
        tree: links of the robot.
        root: name of the root's link.
        stance: its legs and the reference stance.
        masses: masses of legs and body.
        trunk: boxes around the body.
    """

    tree: UrdfTree
    root: str
    stance: Stance
    masses: Masses
    trunk: tuple[Box, ...]

    @property
    def com(self) -> Float[np.ndarray, " 3"]:
        """Centre of mass in the root frame, in the reference stance [m]."""
        moment = self.masses.body.mass * self.masses.body.com
        for leg, model in zip(self.stance.legs, self.models(), strict=True):
            posture = model.posture(leg.reference)
            moment = moment + model.mass_moment(posture.frames, posture.origins)
        return moment / self.masses.total

    def models(self) -> list[LimbModel]:
        """Return joints and masses of the legs, without shapes and reach."""
        anywhere = Polytope(np.array([[0.0, 0.0, 1.0]]), np.array([10.0]))
        rows = zip(self.stance.legs, self.masses.links, self.masses.centres, strict=True)
        return [
            LimbModel(leg.chain, leg.reference, mass, centre, (), (), anywhere)
            for leg, mass, centre in rows
        ]


def sketch_robot(path: Path, options: MakeOptions, say: Say) -> Sketch:
    """Return a robot as far as its URDF and the choices say at once.

    Args:
        path: URDF file.
        options: choices for the robot.
        say: told what was found instead of stated.

    Raises:
        InputError: says what is wrong with the URDF or the choices.
    """
    search = MeshSearch(path, tuple(Path(each) for each in options.packages))
    tree = read_tree(path, search)
    root = options.root or tree.root
    tree.require_link(root, "--root")
    for link in (*options.feet, *options.hands):
        tree.require_link(link, "--feet" if link in options.feet else "--hands")
    _require_joints(tree, options)
    _say_missed(tree, search, say)
    stance = make_stance(tree, root, options, say)
    sketch = _with_masses(tree, root, stance, options)
    if _may_balance(stance, options):
        for _ in range(5):  # the legs move the centre of mass a little
            x, y = float(sketch.com[0]), abs(float(stance.legs[0].sole[1]))
            placed = options.model_copy(
                update={"reference_sole": (round(x, 4), round(y, 4)), "root_height": stance.height}
            )
            stance = make_stance(tree, root, placed, lambda _: None, stance.angles)
            sketch = _with_masses(tree, root, stance, options)
        say(f"soles stand at x = {stance.legs[0].sole[0]:.3f} m, below the centre of mass")
    return sketch


def _with_masses(tree: UrdfTree, root: str, stance: Stance, options: MakeOptions) -> Sketch:
    poses = tree.poses(stance.angles, root)
    masses = masses_of(tree, root, poses, stance.legs)
    if options.trunk is not None:
        trunk = tuple(Box(each.low, each.high) for each in options.trunk)
    else:
        trunk = trunk_boxes(tree, root, poses, stance.legs)
    return Sketch(tree, root, stance, masses, trunk)


def _may_balance(stance: Stance, options: MakeOptions) -> bool:
    """Tell whether the soles of a biped may be put below its centre of mass."""
    stated = options.reference_sole is not None or any(
        name in options.reference for leg in stance.legs for name in leg.chain.names
    )
    return len(stance.legs) == 2 and not stated


def _require_joints(tree: UrdfTree, options: MakeOptions) -> None:
    """Refuse names of joints that the URDF does not have."""
    names = [joint.name for joint in tree.joints if joint.kind != "fixed"]
    for key, stated in (("reference", options.reference), ("limits", options.limits)):
        for name in stated:
            if name not in names:
                near = difflib.get_close_matches(name, names, n=1)
                hint = f"; did you mean {near[0]}?" if near else f"; it has {', '.join(names[:60])}"
                raise InputError(
                    f"{tree.path} has no joint that moves called '{name}', which {key} names{hint}"
                )


def _say_missed(tree: UrdfTree, search: MeshSearch, say: Say) -> None:
    """Say which meshes are missed, and for how many links an inertia stands in."""
    if not search.missed:
        return
    guessed = sum(body.guessed for body in tree.bodies.values())
    name, reason = next(iter(search.missed.items()))
    more = f" and {len(search.missed) - 1} more" if len(search.missed) > 1 else ""
    say(
        f"meshes are missed ({name}: {reason}{more}): for {guessed} links a box of the same mass"
        " and inertia stands in (--packages names folders of meshes)"
    )
