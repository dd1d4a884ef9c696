"""Worlds: a robot on level ground, or on a scene as boxes and convex meshes, as one MJCF text."""

from xml.etree import ElementTree
from xml.etree.ElementTree import Element, SubElement

from jaxleas.physics.bodies import Body
from jaxleas.terrain import Scene, scene_mjcf

LIMIT = 1_000.0
"""Half size of level ground as it is drawn; it has no end [m]."""


def world_mjcf(body: Body, scene: Scene | None = None) -> str:
    """Return a robot and what it walks on as one MJCF text.

    Args:
        body: robot.
        scene: scene whose surfaces and obstacles become bodies; None for level ground at height 0.
    """
    root = ElementTree.fromstring(body.mjcf)
    ground = _level() if scene is None else scene_mjcf(scene)
    for kind in ("asset", "worldbody"):
        given = ground.find(kind)
        if given is None:
            continue
        place = root.find(kind)
        if place is None:
            place = SubElement(root, kind)
        for index, element in enumerate(given):
            for key in ("name", "mesh"):
                if key in element.attrib:  # nothing of the robot has such a name
                    element.set(key, f"terrain/{element.get(key)}")
            # The defaults of the robot's file let its own geoms pass through each other; the
            # ground must meet them.
            if element.tag == "geom":
                element.attrib |= {"contype": "1", "conaffinity": "1"}
            place.insert(index, element)
    return ElementTree.tostring(root, encoding="unicode")


def _level() -> Element:
    root = Element("mujoco")
    world = SubElement(root, "worldbody")
    SubElement(world, "geom", {"name": "ground", "type": "plane", "size": f"{LIMIT:g} {LIMIT:g} 1"})
    return root
