"""Make jaxleas/robots/data/talos.json from the published URDF of Talos (see make_robot.py).

The trunk's boxes are those of the published `talos-rbprm` trunk meshes (BSD-2, CNRS / LAAS): pelvis
and thighs' roots below, torso above, without arms. The horizontal reach is that of the published
*reduced* range of motion, |x| <= 0.35 m and y <= 0.30 m, which is what the thesis walked with (its
paths lie up to 40 cm off the surfaces). Friction 0.5, reference height and sole size are the
planner's published settings; steps of at most 0.32 m, with feet at least 0.17 m apart sideways
(soles are 0.12 m wide), are what the published reduced set keeps, too. The boxes of the legs are
those around the collision meshes, and the reference configuration is the SRDF's "half_sitting".
"""

from pathlib import Path

import numpy as np
import pinocchio as pin  # pyright: ignore[reportMissingImports]  # its wheel adds a .pth
import trimesh
from make_robot import main
from robot_recipe import Recipe, Shapes

from jaxleas.geometry import Box
from jaxleas.robots import Capsule, LinkBox

SOLE = (0.0, 0.0, -0.107)
MESHES = {2: "hip_y", 3: "knee", 5: "ankle_X"}  # by link: thigh, shank, foot
SHANK = 0.325  # [m]
RADIUS = 0.065  # of the capsules of foot and shank [m]


def half_sitting(recipe: Recipe) -> np.ndarray:
    """Return the SRDF's standing configuration of the whole robot."""
    srdf = recipe.path.parents[1] / "srdf/talos.srdf"
    pin.loadReferenceConfigurations(recipe.model, str(srdf), False)
    # The SRDF knows of a floating base, this model does not.
    return recipe.model.referenceConfigurations["half_sitting"][-recipe.model.nq :]


def shapes(folder: Path) -> Shapes:
    """Return the boxes around the collision meshes, and capsules of foot and shank."""
    boxes = []
    for link, mesh in MESHES.items():
        low, high = np.round(trimesh.load(folder / f"meshes/v2/{mesh}_collision.stl").bounds, 4)
        if link == max(MESHES):  # nothing of the foot may be below its sole: there is the ground
            low[2] = max(low[2], SOLE[2])
        boxes.append(LinkBox(link, Box(tuple(low.tolist()), tuple(high.tolist()))))
    foot, height = boxes[-1].box, round(SOLE[2] + RADIUS, 4)
    back, front = round(foot.low[0] + RADIUS, 4), round(foot.high[0] - RADIUS, 4)
    capsules = (
        Capsule(5, (back, 0.0, height), (front, 0.0, height), RADIUS),
        Capsule(3, (0.0, 0.0, 0.0), (0.0, 0.0, -SHANK), RADIUS),
    )
    return Shapes(tuple(boxes), capsules)


RECIPE = Recipe(
    name="talos",
    title="Talos",
    urdf="talos_data/robots/talos_reduced.urdf",
    root="base_link",
    feet=("leg_left_6_link", "leg_right_6_link"),
    sole=SOLE,
    half_size=(0.10, 0.06),
    friction=0.5,
    trunk=(
        Box((-0.2, -0.3, -0.628), (0.133, 0.3, 0.013)),
        Box((-0.237, -0.24, -0.042), (0.12, 0.24, 0.605)),
    ),
    root_height=1.0198,
    walking_height=0.95,
    start_heights=(-0.20, 0.07),
    reference_sole=(0.0, 0.0848, -1.0193),
    reference=lambda recipe: half_sitting(recipe)[recipe.columns(recipe.chain)],
    shapes=shapes,
    whole=half_sitting,
    reach=(0.35, 0.30),
    step=(0.32, 0.17),
)

if __name__ == "__main__":
    main(RECIPE)
