"""Make a biped's file from its published URDF; `make_talos.py` and `make_g1.py` say of which.

    python scripts/make_talos.py [--out FILE] [--samples N] [--pairs N] [--seed S]

needs the development extra: `pin` and `example-robot-data` (the wheel holds data files only, so the
URDF is found by its path). What it does, for the left leg; the right one is its mirror image:

1. *Range of motion*: draws leg configurations uniformly within the joint limits, with the knee bent
   by 0.4 rad or more (a stretched leg is singular and cannot carry the root along), and computes
   where the middle of the sole lies in the root frame. It keeps those in which the sole could stand
   on walkable ground while the root is upright: sole normal within 15 degrees of the vertical
   (rubble tilts by up to 7, the ankle may give the rest); sole lower than the trunk's bottom by
   2 cm; the middle of the foot on its own side of the root, or across it by no more than the foot's
   half width (a foot further across meets the other leg); within the recipe's horizontal reach.
   The convex hull is simplified from outside: starting from its bounding box, it adds the hull's
   face that cuts off the worst corner until no corner is further than 5 mm from the hull, so that
   every kept sample lies inside.
2. *Steps*: "RF_in_LF" holds the positions of the right foot from the left one such that one root
   reaches both; "COM_in_LF" the centre of mass over random pairs of such legs. Frames are parallel
   to the root's: along a guide path a foot lands with the root's heading.
3. *Model*: joints, limits and masses of the URDF, the reference configuration, boxes and capsules,
   and where the reference centre of mass of the whole robot lies as seen by a standing foot.
"""

import argparse
from dataclasses import replace
from pathlib import Path

import numpy as np
import pinocchio as pin  # pyright: ignore[reportMissingImports]  # its wheel adds a .pth
from robot_reach import (
    com_in_foot,
    keep_standing,
    rounded,
    sample_com,
    sample_soles,
    simplify,
    standing_legs,
    step_polytope,
)
from robot_recipe import Recipe
from scipy.spatial import ConvexHull

from jaxleas.geometry import Polytope
from jaxleas.robots import (
    Body,
    Effector,
    Limb,
    LimbModel,
    Robot,
    chain_posture,
    read_chain,
    write_robot,
)

DATA = Path(__file__).parents[1] / "jaxleas/robots/data"


def range_of_motion(recipe: Recipe, samples: int, seed: int) -> Polytope:
    """Return where the middle of the left sole can stand (step 1 above), and print extents."""
    soles, normals = sample_soles(recipe, samples, seed)
    standing = soles[keep_standing(recipe, soles, normals)]
    hull = Polytope.from_points(standing)
    left = rounded(simplify(hull, standing[ConvexHull(standing).vertices]))
    for name, points in (("all soles", soles), ("standing", standing), ("polytope", left.vertices)):
        print(f"{name}: low {points.min(axis=0).round(3)}, high {points.max(axis=0).round(3)} m")
    volumes = ConvexHull(standing).volume, ConvexHull(left.vertices).volume
    print(f"{len(standing)} of {samples} stand; faces {len(hull.offsets)} -> {len(left.offsets)},")
    print(f"volume {volumes[0]:.4f} -> {volumes[1]:.4f} m3;", end=" ")
    print(f"samples outside: {(~left.contains(standing, 1e-6)).sum()}")
    over = np.array([[x, y] for x in (-0.2, 0.0, 0.2) for y in (0.0, recipe.reference_sole[1])])
    for (x, y), low, high in zip(over, *left.z_interval(over), strict=True):
        print(f"z over ({x:+.2f}, {y:+.3f}): [{low:.3f}, {high:.3f}] m")
    return left


def steps(recipe: Recipe, samples: int, pairs: int, seed: int) -> dict[str, Polytope]:
    """Return the polytopes of steps (step 2 above), and print extents."""
    legs, soles = standing_legs(recipe, samples, seed)
    step = step_polytope(recipe, soles)
    com = sample_com(recipe, legs, soles, step, pairs, seed)
    hull = Polytope.from_points(com)
    made = {
        "RF_in_LF": rounded(simplify(step, step.vertices)),
        "COM_in_LF": rounded(simplify(hull, com[ConvexHull(com).vertices])),
    }
    made["LF_in_RF"] = made["RF_in_LF"].mirrored()
    made["COM_in_RF"] = made["COM_in_LF"].mirrored()
    for name, each in made.items():
        extent = each.vertices.min(axis=0).round(3), each.vertices.max(axis=0).round(3)
        print(f"{name}: {len(each.offsets)} faces, from {extent[0]} to {extent[1]} m")
    return made


def leg_and_body(recipe: Recipe, samples: int, seed: int) -> tuple[LimbModel, Body]:
    """Return the left leg's model and the body (step 3 above)."""
    model, digits = recipe.model, recipe.digits
    inertias = [model.inertias[model.getJointId(name)] for name in recipe.chain.names]
    shapes = recipe.shapes(recipe.path.parents[1])
    limits = [np.round(each, digits) for each in (recipe.chain.lower, recipe.chain.upper)]
    chain = replace(recipe.chain, lower=limits[0], upper=limits[1])
    leg = LimbModel(
        chain=chain,
        reference=np.round(recipe.reference(recipe), digits),
        link_mass=np.round([inertia.mass for inertia in inertias], digits),
        link_com=np.round([inertia.lever for inertia in inertias], digits),
        boxes=shapes.boxes,
        capsules=shapes.capsules,
        com_reach=Polytope(np.array([[0.0, 0.0, 1.0]]), np.array([1.0])),
    )
    body = body_of(recipe)
    reach = com_in_foot(recipe, leg, body, samples, seed)
    print(f"body {body.mass} kg, its centre of mass {body.com} m")
    return replace(leg, com_reach=reach), body


def body_of(recipe: Recipe) -> Body:
    """Return mass and centre of mass of all links that are not of the legs."""
    model, data = recipe.model, recipe.model.createData()
    legs = [read_chain(recipe.path, recipe.root, foot).names for foot in recipe.feet]
    joints = {model.getJointId(name) for names in legs for name in names}
    pin.forwardKinematics(model, data, recipe.whole(recipe))
    mass, moment = 0.0, np.zeros(3)
    for joint in set(range(model.njoints)) - joints:
        inertia = model.inertias[joint]
        mass += inertia.mass
        moment += inertia.mass * (data.oMi[joint] * inertia.lever)
    return Body(round(float(mass), recipe.digits), np.round(moment / mass, recipe.digits))


def check(recipe: Recipe, leg: LimbModel) -> None:
    """Compare the soles of both legs with Pinocchio's on a hundred postures."""
    data, rng = recipe.model.createData(), np.random.default_rng(1)
    for foot, model in zip(recipe.feet, (leg, leg.mirrored()), strict=True):
        chain = read_chain(recipe.path, recipe.root, foot, model.chain.tip)
        frame = recipe.model.getFrameId(foot)
        for angles in rng.uniform(chain.lower, chain.upper, (50, len(chain))):
            whole = pin.neutral(recipe.model)
            whole[recipe.columns(chain)] = angles
            pin.framesForwardKinematics(recipe.model, data, whole)
            sole = data.oMf[frame] * model.chain.tip.position
            np.testing.assert_allclose(chain_posture(model.chain, angles).tip, sole, atol=1e-9)


def make(recipe: Recipe, samples: int, pairs: int, seed: int) -> Robot:
    """Return the robot of a recipe."""
    left = range_of_motion(recipe, samples, seed)
    polytopes = steps(recipe, samples // 2, pairs, seed)
    leg, body = leg_and_body(recipe, samples // 4, seed)
    check(recipe, leg)
    x, y, z = recipe.reference_sole
    feet = [
        Effector(name, "foot", recipe.half_size, recipe.friction, None, link, model.chain.tip)
        for name, link, model in zip(("LF", "RF"), recipe.feet, (leg, leg.mirrored()), strict=True)
    ]
    return Robot(
        name=recipe.name,
        limbs=(
            Limb("left", left, feet[0], (x, y, z), leg),
            Limb("right", left.mirrored(), feet[1], (x, -y, z), leg.mirrored()),
        ),
        trunk=recipe.trunk,
        root_height=recipe.root_height,
        walking_height=recipe.walking_height,
        mass=round(float(sum(inertia.mass for inertia in recipe.model.inertias)), 3),
        friction=recipe.friction,
        foot_half_size=recipe.half_size,
        start_heights=recipe.start_heights,
        contact_window=recipe.contact_window,
        steps=polytopes,
        body=body,
    )


def main(recipe: Recipe) -> None:
    """Make the file of a recipe and print what was measured."""
    parser = argparse.ArgumentParser(description=f"Make {recipe.name}.json from {recipe.urdf}.")
    parser.add_argument("--out", type=Path, default=DATA / f"{recipe.name}.json")
    parser.add_argument("--samples", type=int, default=4_000_000)
    parser.add_argument("--pairs", type=int, default=40_000)
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()
    robot = make(recipe, arguments.samples, arguments.pairs, arguments.seed)
    about = (
        f"{recipe.title} from {Path(recipe.urdf).name} (example-robot-data), made by"
        f" scripts/make_{recipe.name}.py; metres, kilograms, radians, root frame; a limb's range of"
        " motion is {x : normals x <= offsets}, X_in_Y is X's position in the frame of foot Y"
    )
    notes = {"about": about, "seed": arguments.seed, "samples": arguments.samples}
    write_robot(arguments.out, robot, **notes, pairs=arguments.pairs)
    print(f"wrote {arguments.out}, {arguments.out.stat().st_size} bytes")
