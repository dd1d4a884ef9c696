"""Toy robots with modelled legs: three legs with soles, and four with point feet."""

import numpy as np

from jaxleas.geometry import Box, Polytope
from jaxleas.robots import Effector, Limb, Robot
from jaxleas.robots.chain import SerialChain
from jaxleas.robots.limb_model import Body, Capsule, LimbModel, LinkBox
from jaxleas.terrain.scene import Scene
from jaxleas.types.poses import Pose

from .worlds import floor

HEIGHT = 0.6
"""Height of the roots above the ground [m]."""
AXES = np.eye(3)
THREE = {"FL": (0.28, 0.2), "FR": (0.28, -0.2), "H": (-0.32, 0.0)}
FOUR = {"LF": (0.3, 0.18), "RF": (0.3, -0.18), "LH": (-0.3, 0.18), "RH": (-0.3, -0.18)}
"""Places of the feet below the roots [m]."""


def com_reach(place: tuple[float, float]) -> Polytope:
    """Return a box around the root, as a foot at its place sees it."""
    middle = np.array([-place[0], -place[1], HEIGHT])
    low, high = middle - np.array([0.6, 0.3, 0.35]), middle + np.array([0.6, 0.3, 0.2])
    return Polytope.from_box(Box(tuple(low.tolist()), tuple(high.tolist())))


def leg_with_sole(place: tuple[float, float], thigh: float) -> LimbModel:
    """Return a leg of six joints, whose hip is above the place of its foot."""
    shank, sole = 0.35, 0.05
    down = np.array([0.0, 0.0, -1.0])
    positions = np.zeros((6, 3))
    positions[0] = [*place, 0.0]
    positions[3], positions[4] = thigh * down, shank * down
    # Of the triangle of thigh, shank and the way from hip to ankle.
    way = HEIGHT - sole
    hip = np.arccos((thigh**2 + way**2 - shank**2) / (2 * thigh * way))
    knee = np.pi - np.arccos((thigh**2 + shank**2 - way**2) / (2 * thigh * shank))
    return LimbModel(
        chain=SerialChain(
            names=("yaw", "roll", "pitch", "knee", "ankle pitch", "ankle roll"),
            positions=positions,
            rotations=np.tile(np.eye(3), (6, 1, 1)),
            axes=AXES[[2, 0, 1, 1, 1, 0]],
            lower=np.array([-0.6, -0.6, -1.6, 0.0, -1.2, -0.6]),
            upper=np.array([0.6, 0.6, 1.2, 2.4, 1.2, 0.6]),
            tip=Pose(sole * down, np.array([1.0, 0.0, 0.0, 0.0])),
        ),
        reference=np.array([0.0, 0.0, -hip, knee, hip - knee, 0.0]),
        link_mass=np.array([0.2, 0.2, 1.0, 0.6, 0.1, 0.2]),
        link_com=np.outer([0.0, 0.0, 0.15, 0.15, 0.0, 0.02], down),
        boxes=(
            LinkBox(3, Box((-0.02, -0.02, -0.3), (0.02, 0.02, 0.0))),
            LinkBox(5, Box((-0.05, -0.04, -0.05), (0.05, 0.04, -0.01))),
        ),
        capsules=(Capsule(3, (0.0, 0.0, -0.3), (0.0, 0.0, -0.05), 0.03),),
        com_reach=com_reach(place),
    )


def leg_with_point(place: tuple[float, float], knee_sign: float) -> LimbModel:
    """Return a leg of three joints, whose knee bends one way or the other."""
    thigh, shank = 0.35, 0.36
    positions = np.array([[*place, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, -thigh]])
    hip = np.arccos((thigh**2 + HEIGHT**2 - shank**2) / (2 * thigh * HEIGHT))
    knee = np.pi - np.arccos((thigh**2 + shank**2 - HEIGHT**2) / (2 * thigh * shank))
    bend = sorted((0.05 * knee_sign, 2.4 * knee_sign))
    return LimbModel(
        chain=SerialChain(
            names=("roll", "pitch", "knee"),
            positions=positions,
            rotations=np.tile(np.eye(3), (3, 1, 1)),
            axes=AXES[[0, 1, 1]],
            lower=np.array([-0.6, -1.5, bend[0]]),
            upper=np.array([0.6, 1.5, bend[1]]),
            tip=Pose(np.array([0.0, 0.0, -shank]), np.array([1.0, 0.0, 0.0, 0.0])),
        ),
        reference=np.array([0.0, -knee_sign * hip, knee_sign * knee]),
        link_mass=np.array([0.3, 1.0, 0.4]),
        link_com=np.array([[0.0, 0.0, 0.0], [0.0, 0.0, -0.15], [0.0, 0.0, -0.15]]),
        boxes=(LinkBox(2, Box((-0.015, -0.015, -0.28), (0.015, 0.015, 0.0))),),
        capsules=(Capsule(2, (0.0, 0.0, -0.3), (0.0, 0.0, 0.0), 0.02),),
        com_reach=com_reach(place),
    )


def robot(name: str, models: dict[str, LimbModel], feet: dict[str, Effector]) -> Robot:
    limbs = []
    for foot, model in models.items():
        place = model.posture(model.reference).tip
        low, high = place - np.full(3, 0.3), place + np.array([0.3, 0.3, 0.25])
        reach = Polytope.from_box(Box(tuple(low.tolist()), tuple(high.tolist())))
        limbs.append(Limb(foot, reach, feet[foot], tuple(place.tolist()), model))
    return Robot(
        name=name,
        limbs=tuple(limbs),
        trunk=(Box((-0.25, -0.1, -0.05), (0.25, 0.1, 0.1)),),
        root_height=HEIGHT,
        walking_height=HEIGHT,
        mass=20.0 + sum(float(model.link_mass.sum()) for model in models.values()),
        friction=0.6,
        foot_half_size=(0.05, 0.04),
        body=Body(20.0, np.array([0.0, 0.0, 0.03])),
    )


def tripod() -> Robot:
    """Return a robot with three soles; the leg behind is longer, and its foot is smaller."""
    front = leg_with_sole(THREE["FL"], 0.33)
    models = {"FL": front, "FR": front.mirrored(), "H": leg_with_sole(THREE["H"], 0.37)}
    sizes = {"FL": (0.05, 0.04), "FR": (0.05, 0.04), "H": (0.04, 0.04)}
    friction = {"FL": 0.6, "FR": 0.6, "H": 0.5}
    feet = {foot: Effector(foot, "foot", sizes[foot], friction[foot]) for foot in models}
    return robot("tripod", models, feet)


def quadruped() -> Robot:
    """Return a robot with four point feet; the knees in front bend backwards, others forwards."""
    front, hind = leg_with_point(FOUR["LF"], 1.0), leg_with_point(FOUR["LH"], -1.0)
    models = {"LF": front, "RF": front.mirrored(), "LH": hind, "RH": hind.mirrored()}
    return robot(
        "quadruped", models, {foot: Effector(foot, "point_foot", (0, 0), 0.6) for foot in models}
    )


def stepping_stones(seed: int = 0) -> Scene:
    """Return two floors, and between them stones of slightly different heights with gaps."""
    rng = np.random.default_rng(seed)
    surfaces = {"here": floor(-1.0, 0.9, -1.0, 1.0), "there": floor(2.12, 4.0, -1.0, 1.0)}
    for row, x in enumerate(np.arange(0.95, 2.0, 0.3)):
        for column, y in enumerate(np.arange(-0.6, 0.5, 0.3)):
            z = rng.uniform(-0.04, 0.04)
            surfaces[f"stone_{row}_{column}"] = floor(x, x + 0.22, y, y + 0.22, z)
    return Scene(surfaces)
