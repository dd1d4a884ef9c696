"""The robot's file: made by the script, with the URDF's masses, and primitives alone."""

import subprocess
import sys
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest

from jaxleas.physics import body_names, import_mujoco, load_body
from jaxleas.types import InputError

ROOT = Path(__file__).parents[2]
SHIPPED = ROOT / "jaxleas/physics/data/anymal_b.xml"


def test_the_script_makes_the_shipped_file(tmp_path: Path) -> None:
    out = tmp_path / "anymal_b.xml"
    command = [sys.executable, str(ROOT / "scripts/make_anymal_b.py"), "--out", str(out)]
    subprocess.run(command, check=True, capture_output=True)
    assert out.read_text(encoding="utf-8") == SHIPPED.read_text(encoding="utf-8")


def test_the_file_keeps_its_notice_and_holds_primitives_alone() -> None:
    text = SHIPPED.read_text(encoding="utf-8")
    assert "Copyright 2019 ANYbotics" in text
    assert "3. The name of ANYbotics and ANYmal may not be used" in text
    kinds = {geom.get("type") for geom in ElementTree.fromstring(text).iter("geom")}
    assert kinds - {None} == {"box", "capsule", "sphere"}


def inertia_about_com(model: Any, data: Any) -> np.ndarray:
    """Return the inertia of the whole robot in the world's axes [kg m2]."""
    total = np.zeros((3, 3))
    for body in range(1, model.nbody):
        axes = data.ximat[body].reshape(3, 3)
        arm = data.xipos[body] - data.subtree_com[1]
        own = axes @ np.diag(model.body_inertia[body]) @ axes.T
        total += own + model.body_mass[body] * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    return total


def test_masses_and_places_are_those_of_the_urdf_by_another_program() -> None:
    pin = pytest.importorskip("pinocchio")
    sys.path.insert(0, str(ROOT / "scripts"))
    try:
        from make_anymal_b import URDF  # pyright: ignore[reportMissingImports]
    finally:
        sys.path.pop(0)
    import site

    path = next(
        each for folder in site.getsitepackages() if (each := Path(folder) / URDF).is_file()
    )
    theirs = pin.buildModelFromUrdf(str(path), pin.JointModelFreeFlyer())
    data = theirs.createData()
    mujoco = import_mujoco()
    ours = mujoco.MjModel.from_xml_path(str(SHIPPED))
    state = mujoco.MjData(ours)
    rng = np.random.default_rng(0)
    for _ in range(5):
        quaternion = rng.standard_normal(4)
        quaternion /= np.linalg.norm(quaternion)
        angles = rng.uniform(-1.0, 1.0, 12)
        state.qpos[:] = [0.1, -0.2, 0.3, *quaternion, *angles]
        mujoco.mj_forward(ours, state)
        posture = pin.neutral(theirs)
        posture[:7] = [0.1, -0.2, 0.3, *np.roll(quaternion, -1)]
        for index, name in enumerate(load_body("anymal_b").joints):
            posture[theirs.joints[theirs.getJointId(name)].idx_q] = angles[index]
        com = pin.centerOfMass(theirs, data, posture)
        np.testing.assert_allclose(state.subtree_com[1], com, atol=1e-6)
        pin.ccrba(theirs, data, posture, np.zeros(theirs.nv))
        np.testing.assert_allclose(inertia_about_com(ours, state), data.Ig.inertia, atol=1e-5)
        pin.framesForwardKinematics(theirs, data, posture)
        feet = [data.oMf[theirs.getFrameId(f"{leg}_FOOT")] for leg in ("LF", "RF", "LH", "RH")]
        ball = np.array([each * np.array([0.0, 0.0, 0.02325]) for each in feet])
        np.testing.assert_allclose(state.sensordata[:12].reshape(4, 3), ball, atol=1e-6)


def test_a_body_knows_its_legs() -> None:
    body = load_body("anymal_b")
    assert body_names() == ("anymal_b",)
    assert body.feet == ("LF", "RF", "LH", "RH")
    assert body.joints[:3] == ("LF_HAA", "LF_HFE", "LF_KFE")
    assert body.mass == pytest.approx(30.4754, abs=1e-4)
    model = import_mujoco().MjModel.from_xml_path(str(SHIPPED))
    standing = import_mujoco().MjData(model)
    import_mujoco().mj_resetDataKeyframe(model, standing, 0)
    import_mujoco().mj_forward(model, standing)
    np.testing.assert_allclose(body.com, standing.subtree_com[1] - standing.qpos[:3], atol=1e-9)
    np.testing.assert_allclose(body.inertia, np.diag(inertia_about_com(model, standing)))
    assert body.foot_radius == 0.031
    assert body.largest_torque.tolist() == [80.0] * 12


def test_an_unknown_body_is_refused_with_those_that_exist(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="there is no robot 'spot' for physics, only anymal_b"):
        load_body("spot")
    with pytest.raises(InputError, match="cannot read"):
        load_body(str(tmp_path / "none.xml"))
    broken = tmp_path / "broken.xml"
    broken.write_text("<mujoco><worldbody/></mujoco>")
    with pytest.raises(InputError, match="has no keyframe 'standing'"):
        load_body(str(broken))
    broken.write_text("not XML")
    with pytest.raises(InputError, match="is no MJCF model that MuJoCo loads"):
        load_body(str(broken))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (('name="LF_FOOT"', 'name="LF_BALL"'), "no ball called LF_FOOT"),
        (
            ('<joint name="RF_KFE" axis="0 1 0"', '<joint name="RF_KFE" pos="0 0 1" axis="0 1 0"'),
            "one hinge at its origin",
        ),
        (
            ('<motor name="LF_HFE" joint="LF_HFE"', '<motor name="LF_HFE" joint="LF_KFE"'),
            "motors must be those of its legs",
        ),
    ],
)
def test_a_file_that_is_not_of_such_a_robot_is_refused(
    tmp_path: Path, change: tuple[str, str], message: str
) -> None:
    path = tmp_path / "other.xml"
    text = SHIPPED.read_text(encoding="utf-8")
    assert change[0] in text
    path.write_text(text.replace(*change))
    with pytest.raises(InputError, match=message):
        load_body(str(path))
