"""Robots as MJCF models, by name: those of the package, and the user's own files."""

from dataclasses import dataclass
from functools import cache
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float

from jaxleas.physics.mujoco_extra import import_mujoco
from jaxleas.types import InputError

DEFAULT_BODY = "anymal_b"
FREE_JOINT = 7
"""Number of coordinates of the root, which come first: position and quaternion (w, x, y, z)."""
STANDING = "standing"
"""Name of the keyframe in which a robot stands on level ground."""


@dataclass(frozen=True, eq=False)
class Leg:
    """A leg as a chain of hinges from the root to a point foot.

    Attributes:
        name: name of the foot.
        joints: names of the joints, from the root on.
        offsets: position of each joint, and last of the foot's middle, in the frame of the link
            before [m]; all frames are parallel where the angles are 0.
        axes: unit axis of each joint.
    """

    name: str
    joints: tuple[str, ...]
    offsets: Float[np.ndarray, "J+1 3"]
    axes: Float[np.ndarray, "J 3"]


@dataclass(frozen=True, eq=False)
class Body:
    """A legged robot with a free root, as its MJCF file describes it.

    Attributes:
        name: name of the robot.
        mjcf: text of its file.
        legs: its legs, in the order of their feet in every array.
        standing: angles of all joints in which it stands [rad].
        standing_height: height of the root above level ground then [m].
        mass: mass of the whole robot [kg].
        com: its centre of mass in the root frame where it stands [m].
        inertia: its moments of inertia about axes through that point, parallel to the root's
            [kg m2].
        foot_radius: radius of the feet, which are balls [m].
        largest_torque: largest torque of each joint [Nm].
        time_step: duration of a physics step [s].
    """

    name: str
    mjcf: str
    legs: tuple[Leg, ...]
    standing: Float[np.ndarray, " J"]
    standing_height: float
    mass: float
    com: Float[np.ndarray, "3"]
    inertia: Float[np.ndarray, "3"]
    foot_radius: float
    largest_torque: Float[np.ndarray, " J"]
    time_step: float

    @property
    def feet(self) -> tuple[str, ...]:
        """Names of the feet."""
        return tuple(leg.name for leg in self.legs)

    @property
    def joints(self) -> tuple[str, ...]:
        """Names of all joints, leg after leg, which is their order in every array."""
        return tuple(joint for leg in self.legs for joint in leg.joints)


def body_names() -> tuple[str, ...]:
    """Return the names of the package's robots."""
    shipped = resources.files("jaxleas.physics") / "data"
    names = [file.name for file in shipped.iterdir()]
    return tuple(sorted(name[:-4] for name in names if name.endswith(".xml")))


def load_body(name: str) -> Body:
    """Return a robot of the package, or that of an MJCF file of the user's own.

    Args:
        name: name of a robot, or path of its file, which ends in .xml.

    Raises:
        InputError: there is no such robot, or its file is not that of a robot with a free root,
            motors, and legs of hinges that end in a ball with a site of the foot's name.
        NoPhysicsError: MuJoCo is not installed.
    """
    if name.endswith(".xml"):
        return _own(Path(name))
    if name not in body_names():
        raise InputError(
            f"there is no robot {name!r} for physics, only {', '.join(body_names())} and MJCF files"
            " that you give as a path ending in .xml"
        )
    return _shipped(name)


@cache
def _shipped(name: str) -> Body:
    file = resources.files("jaxleas.physics") / "data" / f"{name}.xml"
    return _read(name, file.read_text(encoding="utf-8"), f"{name}.xml")


def _own(path: Path) -> Body:
    try:
        mjcf = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(
            f"cannot read {path}: {getattr(error, 'strerror', None) or error}"
        ) from error
    return _read(path.stem, mjcf, str(path))


def _read(name: str, mjcf: str, where: str) -> Body:
    mujoco = import_mujoco()
    try:
        model = mujoco.MjModel.from_xml_string(mjcf)
    except ValueError as error:
        raise InputError(f"{where} is no MJCF model that MuJoCo loads: {error}") from error
    key = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_KEY, STANDING)
    if key < 0:
        raise InputError(f"{where} has no keyframe '{STANDING}', in which the robot stands")
    legs = tuple(
        _leg(model, index, where) for index in range(model.nsite) if _is_foot(model, index)
    )
    com, inertia = _com_and_inertia(model, key)
    body = Body(
        name=name,
        mjcf=mjcf,
        legs=legs,
        standing=model.key_qpos[key, FREE_JOINT:].copy(),
        standing_height=float(model.key_qpos[key, 2]),
        mass=float(mujoco.mj_getTotalmass(model)),
        com=com,
        inertia=inertia,
        foot_radius=_foot_radius(model, legs, where),
        largest_torque=model.actuator_ctrlrange[:, 1].copy(),
        time_step=float(model.opt.timestep),
    )
    driven = tuple(model.joint(int(each)).name for each in model.actuator_trnid[:, 0])
    if model.nq != FREE_JOINT + len(body.joints) or driven != body.joints:
        raise InputError(
            f"{where}: after the free root, its joints and motors must be those of its legs in the"
            f" same order, {', '.join(body.joints)}; its motors drive {', '.join(driven)}"
        )
    return body


def _com_and_inertia(model: Any, key: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the centre of mass in the root frame, and the moments of inertia about it."""
    mujoco = import_mujoco()
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, key)
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    masses, places = model.body_mass[:, None], data.xipos
    com = (masses * places).sum(axis=0) / masses.sum()
    axes = data.ximat.reshape(-1, 3, 3)  # of each link's principal inertia
    own = (axes**2 * model.body_inertia[:, None, :]).sum(axis=(0, 2))
    arms = (places - com) ** 2
    moved = (masses * (arms.sum(axis=1, keepdims=True) - arms)).sum(axis=0)
    return com - model.key_qpos[key, :3], own + moved


def _is_foot(model: Any, site: int) -> bool:
    """Return whether a site is on a link that a joint moves."""
    return bool(model.body_parentid[model.site_bodyid[site]])


def _leg(model: Any, site: int, where: str) -> Leg:
    joints, offsets, axes = [], [model.site_pos[site]], []
    body = int(model.site_bodyid[site])
    while model.body_parentid[body]:
        first = int(model.body_jntadr[body])
        turned = np.abs(model.body_quat[body] - [1.0, 0.0, 0.0, 0.0]).max() > 1e-9
        if model.body_jntnum[body] != 1 or turned or np.any(model.jnt_pos[first]):
            raise InputError(
                f"{where}: each link of a leg needs one hinge at its origin and a frame parallel to"
                f" the root's; '{model.body(body).name}' differs"
            )
        joints.append(model.joint(first).name)
        offsets.append(model.body_pos[body])
        axes.append(model.jnt_axis[first])
        body = int(model.body_parentid[body])
    return Leg(
        model.site(site).name, tuple(joints[::-1]), np.array(offsets[::-1]), np.array(axes[::-1])
    )


def _foot_radius(model: Any, legs: tuple[Leg, ...], where: str) -> float:
    """Return the radius of the feet: geoms called NAME_FOOT."""
    names = [f"{leg.name}_FOOT" for leg in legs]
    known = {model.geom(index).name: index for index in range(model.ngeom)}
    missing = [name for name in names if name not in known]
    if missing or not names:
        raise InputError(
            f"{where} has no ball called {(missing or ['LF_FOOT'])[0]}, which is a foot"
        )
    return float(model.geom_size[known[names[0]], 0])
