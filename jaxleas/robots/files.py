"""Reading and writing a robot as one small JSON file."""

from pathlib import Path
from typing import Any

import numpy as np

from jaxleas.files import read_json, write_json
from jaxleas.geometry import Box, Polytope
from jaxleas.robots.effector import Effector
from jaxleas.robots.limb_files import (
    limb_model_from_json,
    limb_model_to_json,
    numbers,
    pose_from_json,
    pose_to_json,
)
from jaxleas.robots.limb_model import Body, LimbModel
from jaxleas.robots.robot import Limb, Robot
from jaxleas.types import InputError


def read_robot(path: str | Path) -> Robot:
    """Return the robot described by a JSON file.

    Files without `effector`, `reference`, `start_heights`, `contact_window` or `steps` come from
    earlier versions: their robots get feet with the file's `foot_half_size` and `friction`.

    Raises:
        InputError: the file is missing, is not JSON, or a key is missing or malformed.
    """
    described = read_json(path)
    try:
        half_length, half_width = described["foot_half_size"]
        optional = {}
        for key in ("start_heights", "contact_window"):
            if key in described:
                one, other = described[key]
                optional[key] = (float(one), float(other))
        return Robot(
            name=str(described["name"]),
            limbs=_limbs(described["limbs"]),
            trunk=tuple(Box(tuple(box["low"]), tuple(box["high"])) for box in described["trunk"]),
            root_height=float(described["root_height"]),
            walking_height=float(described["walking_height"]),
            mass=float(described["mass"]),
            friction=float(described["friction"]),
            foot_half_size=(float(half_length), float(half_width)),
            steps={
                str(name): Polytope(numbers(each["A"]), numbers(each["b"]))
                for name, each in described.get("steps", {}).items()
            },
            body=_body(described.get("body")),
            **optional,
        )
    except KeyError as error:
        raise InputError(f"{path} lacks the key {error}, which a robot needs") from error
    except (TypeError, ValueError, AttributeError) as error:
        raise InputError(f"{path} does not describe a robot: {error}") from error
    except InputError as error:
        raise InputError(f"{path} does not describe a robot: {error}") from error


def write_robot(path: str | Path, robot: Robot, **notes: Any) -> None:
    """Write `robot` as JSON, with `notes` (provenance) that `read_robot` ignores."""
    described = {
        "name": robot.name,
        **notes,
        "mass": robot.mass,
        "friction": robot.friction,
        "root_height": robot.root_height,
        "walking_height": robot.walking_height,
        "foot_half_size": list(robot.foot_half_size),
        "start_heights": list(robot.start_heights),
        "contact_window": list(robot.contact_window),
        "trunk": [{"low": list(box.low), "high": list(box.high)} for box in robot.trunk],
        "limbs": [
            {
                "name": limb.name,
                "effector": _effector_to_json(effector),
                "reference": reference.tolist(),
                "normals": limb.range_of_motion.normals.tolist(),
                "offsets": limb.range_of_motion.offsets.tolist(),
                **_model_to_json(limb, robot.limbs),
            }
            for limb, effector, reference in zip(
                robot.limbs, robot.effectors, robot.references, strict=True
            )
        ],
        "steps": {
            name: {"A": each.normals.tolist(), "b": each.offsets.tolist()}
            for name, each in robot.steps.items()
        },
    }
    if robot.body is not None:
        described["body"] = {"mass": robot.body.mass, "com": robot.body.com.tolist()}
    write_json(path, described)


def _limbs(described: list[dict[str, Any]]) -> tuple[Limb, ...]:
    models: dict[str, LimbModel] = {}
    limbs = []
    for each in described:
        model, mirrored = each.get("model"), each.get("mirror_of")
        if model is not None:
            models[str(each["name"])] = limb_model_from_json(model)
        elif mirrored is not None:
            if mirrored not in models:
                raise ValueError(f"mirror_of: no limb {mirrored!r:.60} with a 'model' comes before")
            models[str(each["name"])] = models[mirrored].mirrored()
        limbs.append(_limb(each, models.get(str(each["name"]))))
    return tuple(limbs)


def _limb(described: dict[str, Any], model: LimbModel | None) -> Limb:
    effector, reference = described.get("effector"), described.get("reference")
    if reference is not None:
        x, y, z = numbers(reference)
        reference = (float(x), float(y), float(z))
    return Limb(
        str(described["name"]),
        Polytope(numbers(described["normals"]), numbers(described["offsets"])),
        None if effector is None else _effector(effector),
        reference,
        model,
    )


def _model_to_json(limb: Limb, limbs: tuple[Limb, ...]) -> dict[str, Any]:
    """Return a limb's model, or the name of the earlier limb whose mirror image it is."""
    if limb.model is None:
        return {}
    content = limb_model_to_json(limb.model)
    for other in limbs[: limbs.index(limb)]:
        if other.model and limb_model_to_json(other.model.mirrored()) == content:
            return {"mirror_of": other.name}
    return {"model": content}


def _body(described: dict[str, Any] | None) -> Body | None:
    if described is None:
        return None
    com = numbers(described["com"])
    if com.shape != (3,) or not np.isfinite(com).all():
        raise ValueError("the body's com must be three finite numbers")
    return Body(float(described["mass"]), com)


def _effector(described: dict[str, Any]) -> Effector:
    half_length, half_width = described["half_size"]
    limit, frame = described.get("force_limit"), described.get("frame")
    placed = {}
    if frame is not None:
        placed["frame"] = pose_from_json(frame)
    return Effector(
        name=str(described["name"]),
        kind=described["kind"],
        half_size=(float(half_length), float(half_width)),
        friction=float(described["friction"]),
        force_limit=None if limit is None else float(limit),
        link=str(described.get("link", "")),
        **placed,
    )


def _effector_to_json(effector: Effector) -> dict[str, Any]:
    return {
        "name": effector.name,
        "kind": effector.kind,
        "half_size": list(effector.half_size),
        "friction": effector.friction,
        "force_limit": effector.force_limit,
        "link": effector.link,
        "frame": pose_to_json(effector.frame),
    }
