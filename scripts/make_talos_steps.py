"""Make jaxleas/contacts/data/talos_steps.json: how far a step and the centre of mass reach.

    python scripts/make_talos_steps.py [--out FILE] [--samples N] [--pairs N] [--seed S]

needs the development extra, and scripts/make_talos.py, whose leg configurations it uses: the root
upright, soles on walkable ground, within the reach of the reduced range of motion.

1. RF_in_LF: positions of the right foot from the left one such that *one* root reaches both: the
   differences of the corners of the two legs' hulls (their Minkowski difference, hence convex), cut
   to steps of at most 0.32 m forwards or backwards and feet at least 0.17 m apart sideways (soles
   are 0.12 m wide), which is what the published reduced set keeps too.
2. COM_in_LF: the centre of mass (URDF masses, arms in the neutral posture) from the left foot, over
   random pairs of such leg configurations whose feet satisfy 1.
3. Hulls are simplified from outside to within 5 mm and mirrored for the other foot.

Frames are parallel to the root's: along a guide path a foot lands with the root's heading.
"""

import argparse
from pathlib import Path

import numpy as np
import pinocchio as pin  # pyright: ignore[reportMissingImports]  # its wheel adds a .pth
from make_talos import (
    LEG,
    find_urdf,
    keep_standing,
    place_soles,
    rounded,
    sample_configurations,
    simplify,
)
from scipy.spatial import ConvexHull

from jaxleas.files import write_json
from jaxleas.geometry import Polytope

STEP_X, LEAST_APART = 0.32, 0.17  # [m]
MIRROR = np.array([1.0, -1.0, 1.0])
# Of the right leg's joints from the left leg's: yaw and the two rolls change sign.
MIRROR_LEG = np.array([-1.0, -1.0, 1.0, 1.0, 1.0, -1.0])
OUT = Path(__file__).parents[1] / "jaxleas/contacts/data/talos_steps.json"


def standing_legs(model: pin.Model, samples: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Return left-leg configurations [N, 6] that stand, and their soles in the root frame."""
    kept = []
    for chunk in range(max(1, samples // 200_000)):
        drawn = sample_configurations(model, min(samples, 200_000), seed + chunk)
        soles, normals = place_soles(model, drawn)
        keep = keep_standing(soles, normals)
        kept.append((drawn[keep], soles[keep]))
    return np.concatenate([a for a, _ in kept]), np.concatenate([b for _, b in kept])


def step_polytope(soles: np.ndarray) -> Polytope:
    """Return RF_in_LF (step 1 above)."""
    left = soles[ConvexHull(soles).vertices]
    differences = (left[:, None, :] * MIRROR - left[None, :, :]).reshape(-1, 3)
    sides = np.array([[1.0, 0, 0], [-1, 0, 0], [0, 1, 0]])
    cut = Polytope.from_points(differences).cut(sides, np.array([STEP_X, STEP_X, -LEAST_APART]))
    return Polytope.from_points(cut.vertices)


def sample_com(
    model: pin.Model, legs: np.ndarray, soles: np.ndarray, step: Polytope, pairs: int, seed: int
) -> np.ndarray:
    """Return centres of mass from the left foot (step 2 above)."""
    rng = np.random.default_rng(seed)
    left, right = rng.integers(len(legs), size=(2, 4 * pairs))
    allowed = step.contains(soles[right] * MIRROR - soles[left])
    left, right = left[allowed][:pairs], right[allowed][:pairs]
    data, whole = model.createData(), pin.neutral(model)
    names = [[name.replace("left", side) for name in LEG] for side in ("left", "right")]
    columns = [[model.joints[model.getJointId(n)].idx_q for n in side] for side in names]
    points = np.zeros((len(left), 3))
    for index, (one, two) in enumerate(zip(left, right, strict=True)):
        whole[columns[0]], whole[columns[1]] = legs[one], legs[two] * MIRROR_LEG
        points[index] = pin.centerOfMass(model, data, whole) - soles[one]
    return points


def main() -> None:
    """Make the file and print what was measured."""
    parser = argparse.ArgumentParser(description="Make talos_steps.json from the published URDF.")
    parser.add_argument("--out", type=Path, default=OUT)
    parser.add_argument("--samples", type=int, default=2_000_000)
    parser.add_argument("--pairs", type=int, default=40_000)
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()
    model = pin.buildModelFromUrdf(str(find_urdf()))
    legs, soles = standing_legs(model, arguments.samples, arguments.seed)
    step = step_polytope(soles)
    com = sample_com(model, legs, soles, step, arguments.pairs, arguments.seed)
    hull = Polytope.from_points(com)
    made = {
        "RF_in_LF": rounded(simplify(step, step.vertices)),
        "COM_in_LF": rounded(simplify(hull, com[ConvexHull(com).vertices])),
    }
    made["LF_in_RF"] = made["RF_in_LF"].mirrored()
    made["COM_in_RF"] = made["COM_in_LF"].mirrored()
    content = {
        "about": "Talos' step polytopes A x <= b [m] from talos_reduced.urdf (example-robot-data),"
        " made by scripts/make_talos_steps.py; X_in_Y is X's position in the frame of foot Y",
        "samples": arguments.samples,
        "pairs": arguments.pairs,
        "seed": arguments.seed,
        "polytopes": {
            name: {"A": each.normals.tolist(), "b": each.offsets.tolist()}
            for name, each in made.items()
        },
    }
    write_json(arguments.out, content)
    for name, each in made.items():
        corners = each.vertices
        extent = corners.min(axis=0).round(3), corners.max(axis=0).round(3)
        print(f"{name}: {len(each.offsets)} faces, from {extent[0]} to {extent[1]} m")


if __name__ == "__main__":
    main()
