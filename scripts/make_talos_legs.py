"""Make jaxleas/robots/data/talos_legs.json from the published URDF of Talos.

    python scripts/make_talos_legs.py [--out FILE] [--samples N] [--seed S]

needs the development extra, like make_talos.py beside it. Lengths, limits, masses and the reference
posture are the URDF's and SRDF's ("half_sitting"); boxes are those around its collision meshes. The
centre-of-mass polytope is the convex hull of where the reference centre of mass of the whole robot
lies as seen by a standing foot (root upright, sole within 15 degrees of level, knee bent by 0.2 rad
or more, foot not across the root's middle by more than half its width), simplified from outside to
26 faces: along the axes, between two and between three of them.
"""

import argparse
import itertools
from pathlib import Path

import numpy as np
import pinocchio as pin  # pyright: ignore[reportMissingImports]  # its wheel adds a .pth
import trimesh
from make_talos import FOOT_HALF_SIZE, KNEE, LEG, MOST_TILT, SOLE_IN_ANKLE, find_urdf, rounded
from scipy.spatial import ConvexHull

from jaxleas.files import write_json
from jaxleas.geometry import Polytope
from jaxleas.robots.leg_kinematics import leg_posture, mass_moment
from jaxleas.robots.legs import MIRRORED_JOINTS, LegModel, read_legs

BOXES = {"thigh_box": "hip_y", "shank_box": "knee", "foot_box": "ankle_X"}
LEAST_KNEE_BEND = 0.2  # [rad]; nearer to straight the leg cannot carry the root along
OUT = Path(__file__).parents[1] / "jaxleas/robots/data/talos_legs.json"


def describe(model: pin.Model, folder: Path) -> dict:
    """Return all but the polytope, from the URDF, its SRDF and its meshes."""
    pin.loadReferenceConfigurations(model, str(folder / "srdf/talos.srdf"), False)
    standing = model.referenceConfigurations["half_sitting"]
    if len(standing) != model.nq:  # the SRDF knows of a floating base, this model does not
        standing = standing[-model.nq :]
    joints = [model.getJointId(name) for name in LEG]
    columns = [model.joints[joint].idx_q for joint in joints]
    offsets = [model.jointPlacements[joint].translation for joint in joints]
    legs = {*joints, *(model.getJointId(name.replace("left", "right")) for name in LEG)}
    body_mass, body_com = body(model, standing, legs)
    boxes = {
        key: [np.round(bound, 4).tolist() for bound in trimesh.load(folder / path(mesh)).bounds]
        for key, mesh in BOXES.items()
    }
    return {
        "hip": np.round(offsets[0], 6).tolist(),
        "thigh": round(-float(offsets[3][2]), 6),
        "shank": round(-float(offsets[4][2]), 6),
        "sole": -float(SOLE_IN_ANKLE[2]),
        "lower": np.round(model.lowerPositionLimit[columns], 6).tolist(),
        "upper": np.round(model.upperPositionLimit[columns], 6).tolist(),
        "reference": np.round(standing[columns], 6).tolist(),
        "link_mass": [round(float(model.inertias[joint].mass), 6) for joint in joints],
        "link_com": [np.round(model.inertias[joint].lever, 6).tolist() for joint in joints],
        "body_mass": round(body_mass, 6),
        "body_com": np.round(body_com, 6).tolist(),
        # Nothing of the foot may be below its sole: there is the ground.
        **{
            key: {"low": [*low[:2], max(low[2], float(SOLE_IN_ANKLE[2]))], "high": high}
            if key == "foot_box"
            else {"low": low, "high": high}
            for key, (low, high) in boxes.items()
        },
    }


def path(mesh: str) -> str:
    """Return where the URDF's package keeps a collision mesh of the legs."""
    return f"meshes/v2/{mesh}_collision.stl"


def body(model: pin.Model, standing: np.ndarray, legs: set[int]) -> tuple[float, np.ndarray]:
    """Return mass and centre of mass of all links that are not of the legs."""
    data = model.createData()
    pin.forwardKinematics(model, data, standing)
    mass, moment = 0.0, np.zeros(3)
    for joint in range(model.njoints):
        if joint not in legs:
            inertia = model.inertias[joint]
            mass += inertia.mass
            moment += inertia.mass * (data.oMi[joint] * inertia.lever)
    return float(mass), moment / mass


def com_in_foot(legs: LegModel, samples: int, seed: int) -> Polytope:
    """Return the hull of the reference centre of mass in the frame of a standing left foot."""
    lower = legs.lower.copy()
    lower[KNEE] = max(lower[KNEE], LEAST_KNEE_BEND)
    angles = np.random.default_rng(seed).uniform(lower, legs.upper, (samples, len(lower)))
    posture = leg_posture(legs, angles)
    level = posture.foot[:, 2, 2] >= np.cos(MOST_TILT)
    below = posture.sole[:, 2] <= -0.4
    own_side = posture.sole[:, 1] >= -FOOT_HALF_SIZE[1]
    keep = level & below & own_side
    rotation, sole = posture.foot[keep], posture.sole[keep]
    yaw = np.arctan2(rotation[:, 1, 0], rotation[:, 0, 0])
    x, y, z = (reference_com(legs) - sole).T
    cosine, sine = np.cos(yaw), np.sin(yaw)
    seen = np.stack([cosine * x + sine * y, cosine * y - sine * x, z], axis=1)
    corners = seen[ConvexHull(seen).vertices]
    ways = [way for way in itertools.product((-1.0, 0.0, 1.0), repeat=3) if any(way)]
    normals = np.array(ways) / np.linalg.norm(ways, axis=1, keepdims=True)
    around = Polytope(normals, (corners @ normals.T).max(axis=0))
    volumes = ConvexHull(corners).volume, ConvexHull(around.vertices).volume
    print(f"volume {volumes[0]:.4f} -> {volumes[1]:.4f} m3")
    print(f"{keep.sum()} of {samples} stand; low {seen.min(axis=0)}, high {seen.max(axis=0)} m")
    return rounded(around)


def reference_com(legs: LegModel) -> np.ndarray:
    """Return the whole robot's centre of mass in the root frame, standing."""
    standing = leg_posture(legs, legs.reference)
    moment = mass_moment(legs, standing.frames, standing.origins)
    both = moment + moment * np.array([1.0, -1.0, 1.0])
    return (legs.body_mass * legs.body_com + both) / legs.mass


def check(model: pin.Model, legs: LegModel) -> None:
    """Compare sole and centre of mass with `pin` on a hundred postures."""
    data, rng = model.createData(), np.random.default_rng(1)
    for side, sign in (("left", 1.0), ("right", -1.0)):
        mirror = np.array([1.0, sign, 1.0])
        for _ in range(50):
            angles = rng.uniform(legs.lower, legs.upper)
            whole = pin.neutral(model)
            for name, angle in zip(LEG, angles, strict=True):
                joint = model.joints[model.getJointId(name.replace("left", side))]
                index = LEG.index(name)
                whole[joint.idx_q] = angle * (1.0 if sign > 0 else MIRRORED_JOINTS[index])
            pin.forwardKinematics(model, data, whole)
            ankle = data.oMi[model.getJointId(LEG[-1].replace("left", side))]
            posture = leg_posture(legs, angles)
            sole = ankle * SOLE_IN_ANKLE
            np.testing.assert_allclose(mirror * posture.sole, sole, atol=1e-6)


def main() -> None:
    """Make the file and print what was measured."""
    parser = argparse.ArgumentParser(description="Make talos_legs.json from the published URDF.")
    parser.add_argument("--out", type=Path, default=OUT)
    parser.add_argument("--samples", type=int, default=1_000_000)
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()

    urdf = find_urdf()
    model = pin.buildModelFromUrdf(str(urdf))
    described = describe(model, urdf.parents[1])
    notes = {
        "about": "The legs of Talos from talos_reduced.urdf (example-robot-data), made by "
        "scripts/make_talos_legs.py; metres, kilograms, radians, root frame",
        "seed": arguments.seed,
        "samples": arguments.samples,
    }
    unit = {"normals": [[0.0, 0.0, 1.0]], "offsets": [1.0]}
    write_json(arguments.out, {**notes, **described, "com_in_foot": unit})
    legs = read_legs(arguments.out)
    check(model, legs)
    polytope = com_in_foot(legs, arguments.samples, arguments.seed)
    shipped = {"normals": polytope.normals.tolist(), "offsets": polytope.offsets.tolist()}
    write_json(arguments.out, {**notes, **described, "com_in_foot": shipped})
    print(f"mass {legs.mass:.3f} kg, reference com {reference_com(legs)}")
    print(f"wrote {arguments.out}: {len(polytope.offsets)} faces")


if __name__ == "__main__":
    main()
