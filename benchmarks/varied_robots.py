"""Robots that differ from what their controller assumes: heavier, longer and shorter shanks."""

import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, get_args
from xml.etree import ElementTree

import numpy as np

from jaxleas.physics import DEFAULT_BODY, Body, Variation, load_body

Varied = Literal["nominal", "heavy", "long", "short"]
VARIED: tuple[Varied, ...] = get_args(Varied)
FRICTION = 0.8  # that of the robot's file
TRUNK = {"heavy": 1.25}
SHANKS = {"long": 1.1, "short": 0.9}
"""Of Tsounis et al. 2020, table III: trunk over its mass, shanks over their length."""


@dataclass(frozen=True, eq=False)
class VariedRobot:
    """A robot in physics.

    Attributes:
        name: name of the variation.
        body: robot as it is, which its controller does not know.
    """

    name: Varied
    body: Body

    def variation(self, count: int) -> Variation:
        """Return how a number of such robots differ from the file of their body."""
        mass = TRUNK.get(self.name, 1.0)
        return Variation(np.full(count, FRICTION), np.full(count, mass))


def varied_robot(name: Varied) -> VariedRobot:
    """Return a robot that differs from ANYmal B as its name says."""
    body = load_body(DEFAULT_BODY)
    if name not in SHANKS:
        return VariedRobot(name, body)
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / f"{DEFAULT_BODY}.xml"
        file.write_text(_with_shanks(body.mjcf, SHANKS[name]), encoding="utf-8")
        return VariedRobot(name, load_body(str(file)))


def _with_shanks(mjcf: str, factor: float) -> str:
    """Return a robot's file whose shanks are longer: their capsule, foot, and inertia's place."""
    root = ElementTree.fromstring(mjcf)
    for link in root.iter("body"):
        if not link.get("name", "").endswith("_SHANK"):
            continue
        for part in (*link.findall("geom"), *link.findall("site"), *link.findall("inertial")):
            if part.get("type") == "box":  # the knee
                continue
            x, y, z = (float(each) for each in part.get("pos", "").split())
            part.set("pos", f"{factor * x} {y} {factor * z}")
            if part.get("type") == "capsule":
                radius, half = (float(each) for each in part.get("size", "").split())
                part.set("size", f"{radius} {factor * half}")
    return ElementTree.tostring(root, encoding="unicode")
