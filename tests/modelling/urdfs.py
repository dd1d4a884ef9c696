"""Small URDFs written by hand, whose kinematics are known."""

from itertools import pairwise
from pathlib import Path

THIGH, SHANK, HIP = 0.4, 0.35, 0.15  # of the point-footed biped [m]


def write(path: Path, links: list[str], joints: list[str]) -> Path:
    path.write_text(f'<robot name="toy">{"".join(links + joints)}</robot>', encoding="utf-8")
    return path


def link(name: str, mass: float = 0.0, com: str = "0 0 0", shape: str = "") -> str:
    tensor = " ".join(f'{key}="{0.01 * mass}"' for key in ("ixx", "iyy", "izz"))
    inertial = (
        f'<inertial><origin xyz="{com}"/><mass value="{mass}"/><inertia {tensor} ixy="0" ixz="0"'
        ' iyz="0"/></inertial>'
        if mass
        else ""
    )
    return f'<link name="{name}">{inertial}{shape}</link>'


def box(size: str, at: str = "0 0 0") -> str:
    inner = f'<geometry><box size="{size}"/></geometry>'
    return f'<collision><origin xyz="{at}"/>{inner}</collision>'


def ball(radius: float, at: str = "0 0 0") -> str:
    inner = f'<geometry><sphere radius="{radius}"/></geometry>'
    return f'<collision><origin xyz="{at}"/>{inner}</collision>'


def mesh(name: str) -> str:
    return f'<collision><geometry><mesh filename="{name}"/></geometry></collision>'


def joint(name: str, ends: tuple[str, str], axis: str, at: str, limits: tuple[float, float]) -> str:
    return (
        f'<joint name="{name}" type="revolute"><parent link="{ends[0]}"/><child link="{ends[1]}"/>'
        f'<origin xyz="{at}"/><axis xyz="{axis}"/>'
        f'<limit lower="{limits[0]}" upper="{limits[1]}" effort="1" velocity="1"/></joint>'
    )


def fixed(name: str, ends: tuple[str, str], at: str) -> str:
    return (
        f'<joint name="{name}" type="fixed"><parent link="{ends[0]}"/><child link="{ends[1]}"/>'
        f'<origin xyz="{at}"/></joint>'
    )


def stilts(path: Path, scale: float = 1.0) -> Path:
    """A biped on points: hips that roll and pitch about one point, and a knee that bends back."""
    links, joints = [link("base", 20.0, "0 0 0.1", box("0.2 0.2 0.2", "0 0 0.1"))], []
    for side, y in (("l", HIP * scale), ("r", -HIP * scale)):
        links += [link(f"{side}_hip"), link(f"{side}_thigh"), link(f"{side}_shank")]
        links.append(link(f"{side}_foot"))
        down = f"0 0 {-THIGH * scale}"
        joints += [
            joint(f"{side}_roll", ("base", f"{side}_hip"), "1 0 0", f"0 {y} 0", (-0.6, 0.6)),
            joint(f"{side}_pitch", (f"{side}_hip", f"{side}_thigh"), "0 1 0", "0 0 0", (-1.5, 1.5)),
            joint(f"{side}_knee", (f"{side}_thigh", f"{side}_shank"), "0 1 0", down, (0.0, 2.5)),
            fixed(f"{side}_end", (f"{side}_shank", f"{side}_foot"), f"0 0 {-SHANK * scale}"),
        ]
    return write(path, links, joints)


def walker(path: Path, sole: str | None = None, meshes: bool = False) -> Path:
    """A biped with soles 0.2 x 0.1 m, 6 cm below its ankles, and legs of six joints.

    Args:
        path: file to write.
        sole: place of a frame `l_sole` in the frame of the foot; None for no such frame.
        meshes: whether the feet name meshes, which there are not.
    """
    links, joints = [link("base", 20.0, "0 0 0.15", box("0.2 0.3 0.3", "0 0 0.15"))], []
    for side, y in (("l", 0.1), ("r", -0.1)):
        foot = mesh("package://toy/foot.stl") if meshes else box("0.2 0.1 0.02", "0.03 0 -0.05")
        inner = [link(f"{side}_{name}", 0.1) for name in ("yaw", "roll", "ankle")]
        links += [*inner, link(f"{side}_thigh", 3.0, "0 0 -0.2", box("0.1 0.1 0.3", "0 0 -0.2"))]
        links.append(link(f"{side}_shank", 2.0, "0 0 -0.2", box("0.08 0.08 0.2", "0 0 -0.15")))
        links.append(link(f"{side}_foot", 1.0, "0.03 0 -0.05", foot))
        chain = (
            "base",
            *(f"{side}_{n}" for n in ("yaw", "roll", "thigh", "shank", "ankle", "foot")),
        )
        axes = ("0 0 1", "1 0 0", "0 1 0", "0 1 0", "0 1 0", "1 0 0")
        places = (f"0 {y} 0", "0 0 0", "0 0 0", "0 0 -0.4", "0 0 -0.4", "0 0 0")
        limits = ((-0.6, 0.6), (-0.6, 0.6), (-1.8, 0.8), (0.0, 2.3), (-1.2, 0.9), (-0.5, 0.5))
        names = ("yaw", "roll", "pitch", "knee", "ankle_pitch", "ankle_roll")
        rows = zip(names, pairwise(chain), axes, places, limits, strict=True)
        joints += [joint(f"{side}_{name}", *rest) for name, *rest in rows]
        if sole is not None:
            links.append(link(f"{side}_sole"))
            joints.append(fixed(f"{side}_at_sole", (f"{side}_foot", f"{side}_sole"), sole))
    return write(path, links, joints)
