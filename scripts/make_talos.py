"""Make jaxleas/robots/data/talos.json from the published URDF of Talos.

    python scripts/make_talos.py [--out FILE] [--samples N] [--seed S]

needs the development extra: `pin` and `example-robot-data` (the wheel holds data files only, so the
URDF is found by its path). What it does, for the left leg; the right one is its mirror image:

1. draws leg configurations uniformly within the joint limits, with the knee bent by 0.4 rad or more
   (a stretched leg is singular and cannot carry the root along), and computes where the middle of
   the sole lies in the root frame (forward kinematics with the URDF's own placements);
2. keeps those in which the sole could stand on walkable ground while the root is upright: sole
   normal within 15 degrees of the vertical (rubble tilts by up to 7, the ankle may give the rest);
   sole lower than the trunk's bottom by 2 cm; the middle of the foot on its own side of the root,
   or across it by no more than the foot's half width (a foot further across meets the other leg);
   and within the horizontal reach of the published *reduced* range of motion, |x| <= 0.35 m and
   y <= 0.30 m, which is what the thesis walked with (its paths lie up to 40 cm off the surfaces);
3. takes the convex hull and simplifies it from outside: starting from its bounding box, it adds
   the hull's face that cuts off the worst corner until no corner is further than 5 mm from the
   hull, so that every kept sample lies inside.

The trunk's boxes are those of the published `talos-rbprm` trunk meshes (BSD-2, CNRS / LAAS): pelvis
and thighs' roots below, torso above, without arms. Friction 0.5, reference height and sole size are
the planner's published settings; the mass is the URDF's.
"""

import argparse
import site
from pathlib import Path

import numpy as np
import pinocchio as pin  # pyright: ignore[reportMissingImports]  # its wheel adds a .pth
from scipy.spatial import ConvexHull, HalfspaceIntersection

from jaxleas.geometry import Box, Polytope
from jaxleas.robots import Limb, Robot, write_robot

LEG = [f"leg_left_{number}_joint" for number in range(1, 7)]
SOLE_IN_ANKLE = np.array([0.0, 0.0, -0.107])  # [m]
KNEE, LEAST_KNEE_BEND = 3, 0.4  # index in LEG, [rad]
MOST_TILT = np.deg2rad(15.0)
CLEARANCE = 0.02  # between the sole and the trunk's bottom [m]
REACH_X, REACH_Y = 0.35, 0.30  # of the published reduced set [m]
SIMPLIFIED_WITHIN = 0.005  # [m]
SAMPLES_AT_ONCE = 200_000
FOOT_HALF_SIZE = (0.10, 0.06)
TRUNK = (
    Box((-0.2, -0.3, -0.628), (0.133, 0.3, 0.013)),
    Box((-0.237, -0.24, -0.042), (0.12, 0.24, 0.605)),
)
OUT = Path(__file__).parents[1] / "jaxleas/robots/data/talos.json"


def find_urdf() -> Path:
    """Return the path of the URDF inside the installed `example-robot-data` wheel."""
    inside = "cmeel.prefix/share/example-robot-data/robots/talos_data/robots/talos_reduced.urdf"
    found = [Path(folder) / inside for folder in site.getsitepackages()]
    found = [path for path in found if path.is_file()]
    if not found:
        raise SystemExit("talos_reduced.urdf is not installed: pip install example-robot-data pin")
    return found[0]


def sample_configurations(model: pin.Model, samples: int, seed: int) -> np.ndarray:
    """Draw leg configurations [samples, 6] uniformly within the joint limits [rad]."""
    columns = [model.joints[model.getJointId(name)].idx_q for name in LEG]
    low = model.lowerPositionLimit[columns].copy()
    high = model.upperPositionLimit[columns]
    low[KNEE] = max(low[KNEE], LEAST_KNEE_BEND)
    return np.random.default_rng(seed).uniform(low, high, size=(samples, len(LEG)))


def sample_soles(model: pin.Model, samples: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Draw configurations and place their soles, some at a time to spare memory."""
    configurations = sample_configurations(model, samples, seed)
    chunks = np.array_split(configurations, max(1, samples // SAMPLES_AT_ONCE))
    placed = [place_soles(model, chunk) for chunk in chunks]
    return np.concatenate([p[0] for p in placed]), np.concatenate([p[1] for p in placed])


def place_soles(model: pin.Model, configurations: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the middle [N, 3] [m] and the upward normal [N, 3] of each sole in the root frame.

    All configurations at once, with the placements and axes that `pin` read; checked against
    `pin`'s own forward kinematics on the first hundred.
    """
    turn = np.broadcast_to(np.eye(3), (len(configurations), 3, 3))
    position = np.zeros((len(configurations), 3))
    for column, name in enumerate(LEG):
        joint = model.getJointId(name)
        placement = model.jointPlacements[joint]
        # `pin` names a joint's type by its axis: JointModelRX, RY or RZ.
        axis = np.eye(3)["XYZ".index(model.joints[joint].shortname()[-1])]
        position = position + turn @ placement.translation
        turn = turn @ placement.rotation @ _rotations(axis, configurations[:, column])
    _check_with_pin(model, configurations[:100], position, turn)
    return position + turn @ SOLE_IN_ANKLE, turn[:, :, 2]


def _rotations(axis: np.ndarray, angles: np.ndarray) -> np.ndarray:
    # Rodrigues: I + sin(a) [axis] + (1 - cos(a)) [axis]^2
    cross = pin.skew(axis)
    sine, cosine = np.sin(angles)[:, None, None], np.cos(angles)[:, None, None]
    return np.eye(3) + sine * cross + (1 - cosine) * (cross @ cross)


def _check_with_pin(
    model: pin.Model, configurations: np.ndarray, position: np.ndarray, turn: np.ndarray
) -> None:
    data, whole = model.createData(), pin.neutral(model)
    columns = [model.joints[model.getJointId(name)].idx_q for name in LEG]
    for index, configuration in enumerate(configurations):
        whole[columns] = configuration
        pin.forwardKinematics(model, data, whole)
        placement = data.oMi[model.getJointId(LEG[-1])]
        np.testing.assert_allclose(position[index], placement.translation, atol=1e-12)
        np.testing.assert_allclose(turn[index], placement.rotation, atol=1e-12)


def keep_standing(soles: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """Tell which soles could stand on walkable ground with the root upright (step 2 above)."""
    flat = normals[:, 2] >= np.cos(MOST_TILT)
    below = soles[:, 2] <= min(box.low[2] for box in TRUNK) - CLEARANCE
    own_side = soles[:, 1] >= -FOOT_HALF_SIZE[1]
    within_reach = (np.abs(soles[:, 0]) <= REACH_X) & (soles[:, 1] <= REACH_Y)
    return flat & below & own_side & within_reach


def simplify(hull: Polytope, corners: np.ndarray) -> Polytope:
    """Return fewer faces around `hull`: no corner further than 5 mm outside, nothing cut off."""
    low, high = corners.min(axis=0), corners.max(axis=0)
    simple = Polytope.from_box(Box(tuple(low), tuple(high)))
    middle = corners.mean(axis=0)
    while True:
        halfspaces = np.concatenate([simple.normals, -simple.offsets[:, None]], axis=1)
        outer = HalfspaceIntersection(halfspaces, middle).intersections
        outside = outer @ hull.normals.T - hull.offsets
        worst, face = np.unravel_index(np.argmax(outside), outside.shape)
        if outside[worst, face] <= SIMPLIFIED_WITHIN:
            return simple
        simple = simple.cut(hull.normals[face : face + 1], hull.offsets[face : face + 1])


def rounded(polytope: Polytope) -> Polytope:
    """Round for a readable file: normals to 1e-6, offsets up to the next 1e-5 m."""
    return Polytope(np.round(polytope.normals, 6) + 0.0, np.ceil(polytope.offsets * 1e5) / 1e5)


def main() -> None:
    """Make the file and print what was measured."""
    parser = argparse.ArgumentParser(description="Make talos.json from the published URDF.")
    parser.add_argument("--out", type=Path, default=OUT)
    parser.add_argument("--samples", type=int, default=4_000_000)
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()

    model = pin.buildModelFromUrdf(str(find_urdf()))
    mass = round(float(sum(inertia.mass for inertia in model.inertias)), 3)
    soles, normals = sample_soles(model, arguments.samples, arguments.seed)
    standing = soles[keep_standing(soles, normals)]
    hull = Polytope.from_points(standing)
    left = rounded(simplify(hull, standing[ConvexHull(standing).vertices]))
    robot = Robot(
        name="talos",
        limbs=(Limb("left", left), Limb("right", left.mirrored())),
        trunk=TRUNK,
        root_height=1.0198,
        walking_height=0.95,
        mass=mass,
        friction=0.5,
        foot_half_size=FOOT_HALF_SIZE,
    )
    about = (
        "Talos from talos_reduced.urdf (example-robot-data), made by scripts/make_talos.py; metres "
        "and kilograms, root frame; a limb's range of motion is {x : normals x <= offsets}"
    )
    write_robot(arguments.out, robot, about=about, seed=arguments.seed, samples=arguments.samples)
    report(soles, standing, hull, left, mass)
    print(f"wrote {arguments.out}, {arguments.out.stat().st_size} bytes")


def report(
    soles: np.ndarray, standing: np.ndarray, hull: Polytope, left: Polytope, mass: float
) -> None:
    """Print extents, faces and the z interval over a few points."""
    print(f"mass {mass} kg; {len(soles)} samples, {len(standing)} kept")
    for name, points in (("all soles", soles), ("standing", standing), ("polytope", left.vertices)):
        print(f"{name}: low {points.min(axis=0).round(3)}, high {points.max(axis=0).round(3)} m")
    volumes = ConvexHull(standing).volume, ConvexHull(left.vertices).volume
    print(f"faces {len(hull.offsets)} -> {len(left.offsets)}, volume {volumes[0]:.4f} -> ", end="")
    print(f"{volumes[1]:.4f} m3; samples outside: {(~left.contains(standing, 1e-6)).sum()}")
    over = np.array([[x, y] for x in (-0.3, -0.1, 0.0, 0.1, 0.3) for y in (0.0, 0.085, 0.2)])
    for (x, y), low, high in zip(over, *left.z_interval(over), strict=True):
        print(f"z over ({x:+.2f}, {y:+.3f}): [{low:.3f}, {high:.3f}] m")


if __name__ == "__main__":
    main()
