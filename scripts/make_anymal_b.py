"""Make jaxleas/physics/data/anymal_b.xml, an MJCF of primitives alone, from ANYmal B's URDF.

    python scripts/make_anymal_b.py [--out FILE]

needs the development extra: the URDF is that of `example-robot-data` (BSD-3, ANYbotics; the notice
stands at the top of the file made). Links joined by fixed joints become one body: their masses,
first and second moments are added. Every collision shape of the URDF is kept; a cylinder becomes
the capsule of the same radius that reaches as far along its axis, or, where it is shorter than
thick, the box around it less the corners that stick out of it (the square inside its circle):
MuJoCo collides boxes, capsules and spheres with boxes by formulas of their own, cylinders by
iteration. The robot does not collide with itself. Legs come
in the order LF, RF, LH, RH.

What the URDF does not state is chosen here: the reflected inertia of the drives, and the friction
of the feet, which their priority makes that of every contact.
"""

import argparse
import site
from dataclasses import dataclass, field
from pathlib import Path
from xml.etree import ElementTree
from xml.etree.ElementTree import Element, SubElement

import numpy as np
from scipy.spatial.transform import Rotation

URDF = "cmeel.prefix/share/example-robot-data/robots/anymal_b_simple_description/robots/anymal.urdf"
OUT = Path(__file__).parents[1] / "jaxleas/physics/data/anymal_b.xml"
LEGS = ("LF", "RF", "LH", "RH")
STANDING = {"HAA": -0.1, "HFE": 0.7, "KFE": -1.0}  # the SRDF's "standing", of LF [rad]
STANDING_HEIGHT = 0.4792  # of the root, likewise [m]
ARMATURE = 0.01  # of each drive [kg m2]
FRICTION = 0.8  # of the feet, as the URDF tells Gazebo
TIME_STEP = 0.002  # [s]
TOUCH_MARGIN = 0.005  # the site that feels contact is thicker than its foot by this [m]
SMALLEST_INERTIA = 1e-12  # below this a product of inertia is noise of the URDF [kg m2]


@dataclass
class Body:
    """A body: moments about its origin, and shapes."""

    mass: float = 0.0
    moment: np.ndarray = field(default_factory=lambda: np.zeros(3))
    inertia: np.ndarray = field(default_factory=lambda: np.zeros((3, 3)))
    shapes: list[tuple[str, np.ndarray, Rotation, list[float]]] = field(default_factory=list)

    def add(self, mass: float, com: np.ndarray, inertia: np.ndarray) -> None:
        """Add a mass whose inertia about its own centre is given in this body's axes."""
        self.mass += mass
        self.moment += mass * com
        self.inertia += inertia + mass * (com @ com * np.eye(3) - np.outer(com, com))

    @property
    def com(self) -> np.ndarray:
        """Centre of mass [m]."""
        return self.moment / self.mass

    @property
    def inertia_about_com(self) -> np.ndarray:
        """Inertia about the centre of mass [kg m2]."""
        com = self.com
        return self.inertia - self.mass * (com @ com * np.eye(3) - np.outer(com, com))


def numbers(text: str | None, count: int = 3) -> np.ndarray:
    """Return the numbers of an attribute; zeros where there is none."""
    return np.array([float(each) for each in text.split()]) if text else np.zeros(count)


def origin(element: Element | None) -> tuple[np.ndarray, Rotation]:
    """Return the place and rotation that an `origin` states."""
    found = None if element is None else element.find("origin")
    if found is None:
        return np.zeros(3), Rotation.identity()
    return numbers(found.get("xyz")), Rotation.from_euler("xyz", numbers(found.get("rpy")))


def shape_of(geometry: Element) -> tuple[str, list[float]]:
    """Return MuJoCo's name and sizes of a collision shape [m]."""
    shape = geometry[0]
    if shape.tag == "box":
        return "box", (0.5 * numbers(shape.get("size"))).tolist()
    radius = float(shape.get("radius", "nan"))
    if shape.tag == "sphere":
        return "sphere", [radius]
    half = 0.5 * float(shape.get("length", "nan"))
    if half > radius:
        return "capsule", [radius, half - radius]
    return "box", [radius * np.sqrt(0.5), radius * np.sqrt(0.5), half]


class Urdf:
    """The links and joints of a URDF."""

    def __init__(self, path: Path) -> None:
        root = ElementTree.parse(path).getroot()
        self.links = {str(each.get("name")): each for each in root.findall("link")}
        self.joints = root.findall("joint")

    def children(self, link: str) -> list[Element]:
        """Return the joints whose parent a link is."""
        found = [(joint, joint.find("parent")) for joint in self.joints]
        return [
            joint for joint, parent in found if parent is not None and parent.get("link") == link
        ]

    def fused(self, link: str) -> tuple[Body, list[tuple[Element, np.ndarray]]]:
        """Return a link with all that is fixed to it, and the joints that move on it."""
        body, moving = Body(), []
        waiting = [(link, np.zeros(3), Rotation.identity())]
        while waiting:
            name, place, turn = waiting.pop(0)
            add_link(body, self.links[name], place, turn)
            for joint in self.children(name):
                offset, rotation = origin(joint)
                there = place + turn.apply(offset)
                child = joint.find("child")
                assert child is not None
                if joint.get("type") == "fixed":
                    waiting.append((str(child.get("link")), there, turn * rotation))
                else:
                    assert (turn * rotation).magnitude() < 1e-9, "a turned joint frame"
                    moving.append((joint, there))
        return body, moving


def add_link(body: Body, link: Element, place: np.ndarray, turn: Rotation) -> None:
    """Add mass and shapes of a link to the body that it is part of."""
    inertial = link.find("inertial")
    if inertial is not None:
        offset, rotation = origin(inertial)
        mass, tensor = inertial.find("mass"), inertial.find("inertia")
        assert mass is not None
        assert tensor is not None
        xx, xy, xz, yy, yz, zz = (
            float(tensor.get(key, "nan")) for key in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
        )
        matrix = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        axes = (turn * rotation).as_matrix()
        body.add(
            float(mass.get("value", "nan")), place + turn.apply(offset), axes @ matrix @ axes.T
        )
    for collision in link.findall("collision"):
        offset, rotation = origin(collision)
        geometry = collision.find("geometry")
        assert geometry is not None
        kind, size = shape_of(geometry)
        body.shapes.append((kind, place + turn.apply(offset), turn * rotation, size))


def text(values: np.ndarray | list[float] | float) -> str:
    """Return numbers as MJCF writes them."""
    return " ".join(f"{each:.12g}" for each in np.reshape(np.round(values, 12) + 0.0, -1))


def write_body(element: Element, body: Body) -> None:
    """Write mass and shapes of a body."""
    inertia = body.inertia_about_com
    inertia = np.where(np.abs(inertia) < SMALLEST_INERTIA, 0.0, inertia)
    full = [*np.diag(inertia), inertia[0, 1], inertia[0, 2], inertia[1, 2]]
    SubElement(
        element,
        "inertial",
        {"pos": text(body.com), "mass": text(body.mass), "fullinertia": text(full)},
    )
    for kind, place, turn, size in body.shapes:
        geom = SubElement(element, "geom", {"type": kind, "size": text(size), "pos": text(place)})
        if turn.magnitude() > 1e-9:
            geom.set("quat", text(np.roll(turn.as_quat(canonical=True), 1)))


def write_leg(urdf: Urdf, trunk: Element, leg: str, hip: tuple[Element, np.ndarray]) -> None:
    """Write the three bodies of a leg, its foot last."""
    parent, (joint, place) = trunk, hip
    while True:
        name, child = str(joint.get("name")), joint.find("child")
        axis, limit = joint.find("axis"), joint.find("limit")
        assert child is not None
        assert axis is not None
        assert limit is not None
        link = str(child.get("link"))
        body, moving = urdf.fused(link)
        parent = SubElement(parent, "body", {"name": link, "pos": text(place)})
        limits = text([float(limit.get(key, "nan")) for key in ("lower", "upper")])
        SubElement(
            parent,
            "joint",
            {"name": name, "axis": text(numbers(axis.get("xyz"))), "range": limits},
        )
        write_body(parent, body)
        if not moving:
            break
        ((joint, place),) = moving
    foot = next(geom for geom in parent.findall("geom") if geom.get("type") == "sphere")
    foot.attrib.update({"name": f"{leg}_FOOT", "class": "foot"})
    radius = float(str(foot.get("size")))
    place = str(foot.get("pos"))
    SubElement(parent, "site", {"name": leg, "pos": place, "size": text(radius + TOUCH_MARGIN)})


def model(urdf: Urdf) -> Element:
    """Return the robot as MJCF."""
    root = Element("mujoco", {"model": "anymal_b"})
    SubElement(root, "compiler", {"angle": "radian", "autolimits": "true"})
    SubElement(root, "option", {"timestep": text(TIME_STEP)})
    default = SubElement(root, "default")
    SubElement(default, "geom", {"contype": "1", "conaffinity": "0", "rgba": "0.7 0.7 0.7 1"})
    SubElement(default, "joint", {"armature": text(ARMATURE)})
    foot = SubElement(default, "default", {"class": "foot"})
    SubElement(foot, "geom", {"priority": "1", "friction": text([FRICTION, 0.005, 0.0001])})
    world = SubElement(root, "worldbody")
    trunk = SubElement(world, "body", {"name": "base", "pos": text([0.0, 0.0, STANDING_HEIGHT])})
    SubElement(trunk, "freejoint", {"name": "root"})
    body, moving = urdf.fused("base")
    write_body(trunk, body)
    SubElement(trunk, "site", {"name": "base"})
    hips = {str(joint.get("name"))[:2]: (joint, place) for joint, place in moving}
    for leg in LEGS:
        write_leg(urdf, trunk, leg, hips[leg])
    write_drives_and_sensors(root, urdf)
    return root


def write_drives_and_sensors(root: Element, urdf: Urdf) -> None:
    """Write what acts on the robot, what it feels, and how it stands."""
    actuator, sensor = SubElement(root, "actuator"), SubElement(root, "sensor")
    effort = {}
    for joint in urdf.joints:
        limit = joint.find("limit")
        if limit is not None:
            effort[str(joint.get("name"))] = float(limit.get("effort", "nan"))
    names = [f"{leg}_{joint}" for leg in LEGS for joint in STANDING]
    for name in names:
        limits = text([-effort[name], effort[name]])
        SubElement(actuator, "motor", {"name": name, "joint": name, "ctrlrange": limits})
    for leg in LEGS:
        SubElement(sensor, "framepos", {"objtype": "site", "objname": leg})
    for leg in LEGS:
        SubElement(sensor, "touch", {"site": leg})
    SubElement(sensor, "subtreecom", {"body": "base"})
    SubElement(sensor, "subtreelinvel", {"body": "base"})
    SubElement(sensor, "framequat", {"objtype": "site", "objname": "base"})
    SubElement(sensor, "frameangvel", {"objtype": "site", "objname": "base"})
    # Hips turn outwards about x on both sides; hind legs are front legs turned about z.
    signs = {
        leg: (1.0 if leg[0] == "L" else -1.0, *(2 * [1.0 if leg[1] == "F" else -1.0]))
        for leg in LEGS
    }
    angles = [
        sign * angle
        for leg in LEGS
        for sign, angle in zip(signs[leg], STANDING.values(), strict=True)
    ]
    pose = text([0.0, 0.0, STANDING_HEIGHT, 1.0, 0.0, 0.0, 0.0, *angles])
    SubElement(SubElement(root, "keyframe"), "key", {"name": "standing", "qpos": pose})


NOTICE = """
  ANYmal B as primitives, made by scripts/make_anymal_b.py from the URDF of
  anymal_b_simple_description, in the edition of example-robot-data; metres, kilograms, radians.

  Copyright 2019 ANYbotics, https://www.anybotics.com

  Redistribution and use in source and binary forms, with or without modification, are permitted
  provided that the following conditions are met:

  1. Redistributions of source code must retain the above copyright notice, this list of conditions
  and the following disclaimer.

  2. Redistributions in binary form must reproduce the above copyright notice, this list of
  conditions and the following disclaimer in the documentation and/or other materials provided with
  the distribution.

  3. The name of ANYbotics and ANYmal may not be used to endorse or promote products derived from
  this software without specific prior written permission.

  THIS SOFTWARE IS PROVIDED BY THE COPYRIGHT HOLDERS AND CONTRIBUTORS "AS IS" AND ANY EXPRESS OR
  IMPLIED WARRANTIES, INCLUDING, BUT NOT LIMITED TO, THE IMPLIED WARRANTIES OF MERCHANTABILITY AND
  FITNESS FOR A PARTICULAR PURPOSE ARE DISCLAIMED. IN NO EVENT SHALL THE COPYRIGHT HOLDER OR
  CONTRIBUTORS BE LIABLE FOR ANY DIRECT, INDIRECT, INCIDENTAL, SPECIAL, EXEMPLARY, OR CONSEQUENTIAL
  DAMAGES (INCLUDING, BUT NOT LIMITED TO, PROCUREMENT OF SUBSTITUTE GOODS OR SERVICES; LOSS OF USE,
  DATA, OR PROFITS; OR BUSINESS INTERRUPTION) HOWEVER CAUSED AND ON ANY THEORY OF LIABILITY, WHETHER
  IN CONTRACT, STRICT LIABILITY, OR TORT (INCLUDING NEGLIGENCE OR OTHERWISE) ARISING IN ANY WAY OUT
  OF THE USE OF THIS SOFTWARE, EVEN IF ADVISED OF THE POSSIBILITY OF SUCH DAMAGE.
"""


def main() -> None:
    """Make the file."""
    parser = argparse.ArgumentParser(description="Make anymal_b.xml from the published URDF.")
    parser.add_argument("--out", type=Path, default=OUT)
    out = parser.parse_args().out
    found = [Path(folder) / URDF for folder in site.getsitepackages()]
    found = [path for path in found if path.is_file()]
    if not found:
        raise SystemExit("the URDF is not installed: pip install example-robot-data")
    root = model(Urdf(found[0]))
    ElementTree.indent(root)
    body = ElementTree.tostring(root, encoding="unicode")
    out.write_text(f"<!--{NOTICE}-->\n{body}\n", encoding="utf-8")
    print(f"wrote {out}, {out.stat().st_size} bytes")


if __name__ == "__main__":
    main()
