"""The same kinematics by Pinocchio, which shares no code with ours."""

from collections.abc import Mapping
from importlib.util import find_spec
from typing import Any

import numpy as np

from jaxleas.modelling.sketch import Sketch
from jaxleas.robots import chain_posture
from jaxleas.types import InputError

_POSTURES = 50
_FAR = 1e-4
"""Difference of soles or of centres of mass above which ours is not trusted [m]."""


def compare_with_pinocchio(sketch: Sketch) -> str:
    """Compare soles, mass and centre of mass with Pinocchio's, and return what was done.

    Args:
        sketch: robot.

    Raises:
        InputError: the two disagree.
    """
    if find_spec("pinocchio") is None:
        return "not compared with Pinocchio, which is not installed: pip install 'jaxleas[robots]'"
    import pinocchio as pin  # pyright: ignore[reportMissingImports]  # its wheel adds a .pth

    model = pin.buildModelFromUrdf(str(sketch.tree.path), pin.JointModelFreeFlyer())
    data, angles = model.createData(), sketch.stance.angles
    root, whole = model.getFrameId(sketch.root), sketch.root == sketch.tree.root
    pin.centerOfMass(model, data, _posture(pin, model, angles))
    pin.updateFramePlacements(model, data)
    worst = np.abs(data.oMf[root].actInv(data.com[0]) - sketch.com).max() if whole else 0.0
    masses = abs(data.mass[0] - sketch.masses.total) if whole else 0.0
    rng, poses = np.random.default_rng(1), sketch.tree.poses(angles, sketch.root)
    for leg in sketch.stance.legs:
        sole = poses[leg.link].inverse().transform(leg.sole[None])[0]
        for row in rng.uniform(leg.chain.lower, leg.chain.upper, (_POSTURES, len(leg.chain))):
            moved = {**angles, **dict(zip(leg.chain.names, row.tolist(), strict=True))}
            pin.framesForwardKinematics(model, data, _posture(pin, model, moved))
            seen = data.oMf[root].actInv(data.oMf[model.getFrameId(leg.link)].act(sole))
            worst = max(worst, float(np.abs(seen - chain_posture(leg.chain, row).tip).max()))
    if worst > _FAR or masses > _FAR * sketch.masses.total:
        raise InputError(
            f"{sketch.tree.path}: Pinocchio {pin.__version__} finds soles or the centre of mass"
            f" {worst:.4f} m away, and a mass {masses:.4f} kg apart from ours: one of both misreads"
            " this URDF; --no-compare makes the file all the same"
        )
    return (
        f"Pinocchio {pin.__version__} agrees: soles in {_POSTURES} postures of each leg"
        f"{', mass and centre of mass' if whole else ''}, within {max(worst, 1e-9):.0e} m"
    )


def _posture(pin: Any, model: Any, angles: Mapping[str, float]) -> np.ndarray:
    """Return values of joints as Pinocchio counts them."""
    whole = pin.neutral(model)
    for name, angle in angles.items():
        if model.existJointName(name):
            joint = model.joints[model.getJointId(name)]
            turns = joint.nq == 2  # a joint without limits: cosine and sine
            whole[joint.idx_q : joint.idx_q + joint.nq] = (
                [np.cos(angle), np.sin(angle)] if turns else angle
            )
    return whole
