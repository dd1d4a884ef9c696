"""URDFs and choices that are no good: one sentence, and nothing is written."""

from itertools import pairwise

import pytest

from jaxleas import cli
from jaxleas.modelling.options import MakeOptions
from jaxleas.modelling.sketch import sketch_robot
from jaxleas.types import InputError

from . import urdfs
from .urdfs import box, fixed, joint, link

FEET = ("--feet", "l_foot", "r_foot")


def refusal(tmp_path, urdf, *arguments: object) -> str:
    """Return why `robot make` refuses, and see that it leaves nothing."""
    before = sorted(tmp_path.rglob("*"))
    out = tmp_path / "robots/toy.json"
    with pytest.raises(InputError) as refused:
        cli.run(["robot", "make", str(urdf), "--out", str(out), *map(str, arguments)])
    assert sorted(tmp_path.rglob("*")) == before
    return str(refused.value)


def test_frames_that_there_are_are_listed(tmp_path):
    urdf = urdfs.walker(tmp_path / "walker.urdf")
    said = refusal(tmp_path, urdf, "--feet", "l_sole", "r_sole")
    assert "has no link 'l_sole', which --feet names; it has " in said
    assert "l_foot" in said
    assert "base" in said
    said = refusal(tmp_path, urdf, *FEET, "--root", "pelvis")
    assert "'pelvis', which --root names" in said


def test_a_loop_is_refused(tmp_path):
    urdf = urdfs.walker(tmp_path / "walker.urdf")
    again = joint("rod", ("base", "l_foot"), "1 0 0", "0 0 0", (-1, 1))
    urdf.write_text(urdf.read_text().replace("</robot>", f"{again}</robot>"))
    said = refusal(tmp_path, urdf, *FEET)
    assert "has a loop: joints 'l_ankle_roll' and 'rod' both carry link 'l_foot'" in said


@pytest.mark.parametrize("root", [True, False])
def test_links_that_carry_themselves_are_refused(tmp_path, root):
    links = [link(name, 1.0) for name in ("base", "a", "b", "c")]
    joints = [fixed("j", ("a", "b"), "0 0 1"), fixed("k", ("b", "a"), "0 0 1")]
    if root:
        joints.append(fixed("l", ("base", "c"), "0 0 1"))
    urdf = urdfs.write(tmp_path / "ring.urdf", links, joints)
    assert "has a loop" in refusal(tmp_path, urdf, "--feet", "a", "b")


def test_meshes_that_are_not_at_hand_are_said_and_inertia_stands_in(tmp_path, capsys):
    urdf = urdfs.walker(tmp_path / "walker.urdf", meshes=True)
    said = refusal(tmp_path, urdf, *FEET)
    assert "state half_size" in said
    out = capsys.readouterr().out
    assert "meshes are missed (package://toy/foot.stl: it is not at hand): for 2 links a box" in out
    said = refusal(tmp_path, urdf, *FEET, "--half-size", 0.1, 0.05)
    assert "the frame of 'l_foot' is not at its sole: by its inertia" in said
    assert "--sole X Y Z" in said
    options = MakeOptions(feet=("l_foot", "r_foot"), half_size=(0.1, 0.05), sole=(0.03, 0.0, -0.06))
    assert len(sketch_robot(urdf, options, print).stance.legs) == 2, "stated, it can be made"


def test_a_stated_sole_is_checked(tmp_path):
    urdf = urdfs.walker(tmp_path / "walker.urdf")
    said = refusal(tmp_path, urdf, *FEET, "--sole", 0.03, 0, 0)
    assert "the stated sole of 'l_foot' is 0.060 m above the lowest point of the foot" in said
    assert "(0.03, 0, -0.06) m in the link's frame" in said


def test_a_stance_that_contradicts_the_height_is_refused(tmp_path):
    urdf = urdfs.walker(tmp_path / "walker.urdf")
    options = tmp_path / "options.yaml"
    stance = "{l_pitch: -0.4, l_knee: 0.8, l_ankle_pitch: -0.4}"
    options.write_text(f"root_height: 0.86\nreference: {stance}\n")
    assert "0.797 m below the root" in refusal(tmp_path, urdf, *FEET, "--options", options)
    options.write_text("reference: {l_pich: -0.4}\n")
    said = refusal(tmp_path, urdf, *FEET, "--options", options)
    assert (
        "no joint that moves called 'l_pich', which reference names; did you mean l_pitch?" in said
    )
    options.write_text("reach: {aheed: 0.4}\n")
    assert "there is no reach.aheed" in refusal(tmp_path, urdf, *FEET, "--options", options)


def test_a_robot_too_small_for_the_cells_is_refused(tmp_path):
    urdf = urdfs.stilts(tmp_path / "stilts.urdf", scale=0.1)
    said = refusal(tmp_path, urdf, *FEET, "--samples", 20_000)
    assert "too small for the terrain: left reaches over" in said
    assert "cells of 0.04 m" in said


def test_a_leg_that_reaches_no_volume_is_refused(tmp_path):
    urdf = urdfs.walker(tmp_path / "walker.urdf")
    options = tmp_path / "options.yaml"
    stance = ", ".join(
        f"{side}_{name}"
        for side in "lr"
        for name in ("pitch: -0.4", "knee: 0.8", "ankle_pitch: -0.4")
    )
    limits = ", ".join(
        f"{side}_{name}: [0, 0]" for side in "lr" for name in ("yaw", "roll", "ankle_roll")
    )
    options.write_text(f"reference: {{{stance}}}\nlimits: {{{limits}}}\n")
    said = refusal(tmp_path, urdf, *FEET, "--options", options, "--samples", 20_000)
    assert "the range of motion of 'l_foot' spans no volume" in said


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        ((), "feet"),
        (("--feet", "l_foot", "l_foot"), "twice"),
        ((*FEET, "--samples", "3"), "samples"),
        ((*FEET, "--root-height", "3"), "does not bring its sole level"),
        (
            (*FEET, "--walking-height", "0.3", "--samples", "20000"),
            "cannot stand at its reference place",
        ),
        ((*FEET, "--picture", "robot.gif"), "pictures are"),
    ],
)
def test_choices_that_are_no_good_are_refused(tmp_path, arguments, sentence):
    urdf = urdfs.walker(tmp_path / "walker.urdf")
    assert sentence in refusal(tmp_path, urdf, *arguments)


def test_files_that_are_no_urdf_are_refused(tmp_path):
    missing = tmp_path / "none.urdf"
    assert "none.urdf" in refusal(tmp_path, missing, *FEET)
    other = tmp_path / "robot.urdf"
    other.write_text("<mujoco/>")
    assert "not a URDF" in refusal(tmp_path, other, *FEET)
    macro = tmp_path / "robot.xacro"
    macro.write_text("<robot/>")
    assert "xacro" in refusal(tmp_path, macro, *FEET)
    heavy = urdfs.write(
        tmp_path / "nan.urdf",
        [link("base", float("nan")), link("a", 1.0, shape=box("1 1 1"))],
        [joint("j", ("base", "a"), "1 0 0", "0 0 0", (-1, 1))],
    )
    assert "link 'base' is not one of a URDF" in refusal(tmp_path, heavy, "--feet", "a")


def test_endless_chains_are_refused(tmp_path):
    names = [f"link_{index}" for index in range(1000)]
    joints = [fixed(f"to_{b}", (a, b), "0 0 1") for a, b in pairwise(names)]
    urdf = urdfs.write(tmp_path / "chain.urdf", [link(name, 1.0) for name in names], joints)
    assert "has 999 joints, more than the 500 accepted" in refusal(
        tmp_path, urdf, "--feet", "link_9"
    )


def test_an_interrupted_command_leaves_nothing(tmp_path, monkeypatch):
    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    urdf = urdfs.walker(tmp_path / "walker.urdf")
    monkeypatch.setattr("jaxleas.modelling.making.draw_standing", interrupted)
    with pytest.raises(KeyboardInterrupt):
        cli.run(["robot", "make", str(urdf), *FEET, "--out", str(tmp_path / "robots/toy.json")])
    assert list(tmp_path.iterdir()) == [urdf]
