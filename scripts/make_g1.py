"""Make jaxleas/robots/data/g1.json from the published URDF of Unitree's G1 (see make_robot.py).

The URDF is the one with 29 joints (BSD-3-Clause). Its feet touch with four balls of 5 mm, 3 cm
below the ankle: the sole is the rectangle around them. The trunk's lower box holds pelvis and
thighs' roots, the upper one the torso, wide enough for the shoulders; both are chosen by hand. In
the reference configuration the root is 0.75 m above level soles (0.79 m with straight knees), the
centre of mass above their middle, and the feet straight below the hips. The horizontal reach, the
longest step and the distance of the feet are those of Talos times the ratio of the lengths of their
legs. The boxes of the legs are those around the URDF's meshes; that of the shank ends 3 cm above
the ankle, which is only 5 cm above the sole: the corners of a longer one would meet the ground
wherever the shank leans, although the slender shank itself does not.

The hips may turn much further than a walking robot turns them, by +-2.8 rad about the vertical:
their limits are narrowed to little more than those of Talos, within which a pose of the foot has
one posture of the leg and samples are not spent on legs that turn backwards.
"""

from pathlib import Path

import numpy as np
import pinocchio as pin  # pyright: ignore[reportMissingImports]  # its wheel adds a .pth
import trimesh
from make_robot import main
from robot_recipe import Recipe, Shapes

from jaxleas.geometry import Box
from jaxleas.robots import Capsule, LinkBox, numeric_inverse

SOLE = (0.035, 0.0, -0.035)
HIP_Y = 0.064452 + 0.052  # from the root's middle to the leg's plane [m]
MESHES = {1: "hip_roll", 2: "hip_yaw", 3: "knee", 5: "ankle_roll"}  # by link
SHANK = 0.30001  # [m]
ABOVE_ANKLE = 0.03  # where the shank's box ends [m]
FOOT_RADIUS, SHANK_RADIUS = 0.035, 0.045  # of the capsules [m]
BENT = np.array([-0.3, 0.0, 0.0, 0.6, -0.3, 0.0])
"""Near this the reference configuration is looked for [rad]."""


def level_soles(recipe: Recipe) -> np.ndarray:
    """Return the angles of the left leg with which its level sole is at its reference."""
    place = np.array([recipe.reference_sole])
    angles, reached = numeric_inverse(recipe.chain, BENT[None], place, np.eye(3)[None])
    assert reached.all(), "the reference configuration is out of reach"
    return angles[0]


def shapes(folder: Path) -> Shapes:
    """Return the boxes around the meshes, and capsules of foot and shank."""
    boxes = []
    for link, mesh in MESHES.items():
        low, high = np.round(trimesh.load(folder / f"meshes/left_{mesh}_link.STL").bounds, 4)
        if link == max(MESHES):  # nothing of the foot may be below its sole: there is the ground
            low[2] = max(low[2], SOLE[2])
        if mesh == "knee":
            low[2] = max(low[2], ABOVE_ANKLE - SHANK)
        boxes.append(LinkBox(link, Box(tuple(low.tolist()), tuple(high.tolist()))))
    foot, height = boxes[-1].box, round(SOLE[2] + FOOT_RADIUS, 4)
    back, front = round(foot.low[0] + FOOT_RADIUS, 4), round(foot.high[0] - FOOT_RADIUS, 4)
    capsules = (
        Capsule(5, (back, 0.0, height), (front, 0.0, height), FOOT_RADIUS),
        Capsule(3, (0.0, 0.0, 0.0), (0.0, 0.0, -SHANK), SHANK_RADIUS),
    )
    return Shapes(tuple(boxes), capsules)


RECIPE = Recipe(
    name="g1",
    title="Unitree G1",
    urdf="g1_description/urdf/g1_29dof_rev_1_0.urdf",
    root="pelvis",
    feet=("left_ankle_roll_link", "right_ankle_roll_link"),
    sole=SOLE,
    half_size=(0.085, 0.03),
    friction=0.5,
    trunk=(
        Box((-0.12, -0.16, -0.4), (0.12, 0.16, 0.0)),
        Box((-0.12, -0.2, 0.0), (0.12, 0.2, 0.5)),
    ),
    root_height=0.75,
    walking_height=0.70,
    start_heights=(-0.15, 0.04),
    reference_sole=(0.02, round(HIP_Y, 4), -0.75),
    reference=level_soles,
    shapes=shapes,
    whole=lambda recipe: pin.neutral(recipe.model),
    reach=(0.30, 0.26),
    step=(0.27, 0.12),
    contact_window=(0.55, 0.38),
    limits={0: (-2.1, 0.8), 1: (-0.5236, 0.8), 2: (-0.6, 1.2), 3: (0.0, 2.7)},
)

if __name__ == "__main__":
    main(RECIPE)
