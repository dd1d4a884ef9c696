"""Kinematics, masses and shapes of limbs as JSON."""

from typing import Any

import numpy as np

from jaxleas.geometry import Box, Polytope
from jaxleas.robots.chain import SerialChain
from jaxleas.robots.limb_model import Capsule, LimbModel, LinkBox
from jaxleas.types import Pose, quaternion_of


def limb_model_to_json(model: LimbModel) -> dict[str, Any]:
    """Return a limb's model as JSON values."""
    chain = model.chain
    turns = quaternion_of(chain.rotations)
    return {
        "joints": [
            {
                "name": name,
                "position": chain.positions[index].tolist(),
                "quaternion": turns[index].tolist(),
                "axis": chain.axes[index].tolist(),
                "lower": float(chain.lower[index]),
                "upper": float(chain.upper[index]),
                "reference": float(model.reference[index]),
                "mass": float(model.link_mass[index]),
                "com": model.link_com[index].tolist(),
            }
            for index, name in enumerate(chain.names)
        ],
        "tip": pose_to_json(chain.tip),
        "boxes": [
            {"link": each.link, "low": list(each.box.low), "high": list(each.box.high)}
            for each in model.boxes
        ],
        "capsules": [
            {
                "link": each.link,
                "start": list(each.start),
                "end": list(each.end),
                "radius": each.radius,
            }
            for each in model.capsules
        ],
        "com_reach": {
            "normals": model.com_reach.normals.tolist(),
            "offsets": model.com_reach.offsets.tolist(),
        },
    }


def limb_model_from_json(content: dict[str, Any]) -> LimbModel:
    """Return a limb's model from JSON values.

    Raises:
        KeyError, TypeError, ValueError, InputError: the values do not describe a model.
    """
    joints = content["joints"]
    chain = SerialChain(
        names=tuple(str(joint["name"]) for joint in joints),
        positions=_column(joints, "position"),
        rotations=np.array(
            [Pose(np.zeros(3), numbers(joint["quaternion"])).rotation for joint in joints]
        ),
        axes=_column(joints, "axis"),
        lower=_column(joints, "lower"),
        upper=_column(joints, "upper"),
        tip=pose_from_json(content["tip"]),
    )
    reach = content["com_reach"]
    return LimbModel(
        chain=chain,
        reference=_column(joints, "reference"),
        link_mass=_column(joints, "mass"),
        link_com=_column(joints, "com"),
        boxes=tuple(
            LinkBox(int(each["link"]), Box(_point(each["low"]), _point(each["high"])))
            for each in content["boxes"]
        ),
        capsules=tuple(
            Capsule(
                int(each["link"]),
                _point(each["start"]),
                _point(each["end"]),
                float(each["radius"]),
            )
            for each in content["capsules"]
        ),
        com_reach=Polytope(numbers(reach["normals"]), numbers(reach["offsets"])),
    )


def pose_to_json(pose: Pose) -> dict[str, Any]:
    """Return a pose as JSON values."""
    return {"position": pose.position.tolist(), "quaternion": pose.quaternion.tolist()}


def pose_from_json(content: dict[str, Any]) -> Pose:
    """Return a pose from JSON values."""
    return Pose(numbers(content["position"]), numbers(content["quaternion"]))


def numbers(value: Any) -> np.ndarray:
    """Return nested lists of numbers as an array.

    Raises:
        ValueError: the lists hold something else, or are ragged.
    """
    return np.asarray(value, dtype=np.float64)


def _column(joints: list[dict[str, Any]], key: str) -> np.ndarray:
    return numbers([joint[key] for joint in joints])


def _point(value: Any) -> tuple[float, float, float]:
    x, y, z = numbers(value).tolist()
    return (x, y, z)
