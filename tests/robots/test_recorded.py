"""The robot that guide path files record, and the robot that is planned with."""

from dataclasses import replace

import numpy as np
import pytest

from jaxleas.robots import RecordedRobot, load_robot, load_talos, robot_for, write_robot
from jaxleas.robots.heights import height_complaint
from jaxleas.types import InputError


def test_a_record_survives_as_arrays() -> None:
    written = RecordedRobot.of("g1")
    assert RecordedRobot.from_arrays(written.to_arrays(), "file") == written
    assert written.walking_height == load_robot("g1").walking_height
    assert RecordedRobot.from_arrays({"time": np.zeros(3)}, "file") is None


@pytest.mark.parametrize(
    "change",
    [
        {"robot": np.array(3)},
        {"robot": np.array("")},
        {"robot_sha256": np.array([1, 2])},
        {"walking_height": np.array("high")},
        {"walking_height": np.array(np.nan)},
        {"walking_height": np.zeros(2)},
    ],
)
def test_a_damaged_record_is_refused(change) -> None:
    arrays = RecordedRobot.of("g1").to_arrays()
    with pytest.raises(InputError, match=r"^file: "):
        RecordedRobot.from_arrays(arrays | change, "file")
    (key,) = change
    del arrays[key]
    with pytest.raises(InputError, match="or all be left out"):
        RecordedRobot.from_arrays(arrays, "file")


def test_the_robot_that_walked_is_planned_with() -> None:
    g1, talos = RecordedRobot.of("g1"), RecordedRobot.of("talos")
    assert robot_for(g1, "g1", "p.npz").note == ""
    assert robot_for(talos, None, "p.npz").note == ""
    meant = robot_for(g1, None, "p.npz")
    assert (meant.name, meant.note) == ("g1", "p.npz was walked by g1, whose legs are taken")
    assert robot_for(None, None, "p.npz").name == "talos"
    assert robot_for(None, "g1", "p.npz").name == "g1"


def test_another_robots_path_is_refused() -> None:
    with pytest.raises(
        InputError, match=r"robot 'g1', with its root 0\.7 m .* talos walks at 0\.95"
    ):
        robot_for(RecordedRobot.of("g1"), "talos", "p.npz")
    gone = replace(RecordedRobot.of("g1"), name="walker")
    with pytest.raises(InputError, match="'walker', which is not known here: give its file by"):
        robot_for(gone, None, "p.npz")
    with pytest.raises(InputError, match="there is no robot 'nobody'"):
        robot_for(gone, "nobody", "p.npz")


def test_a_robot_that_walks_as_high_may_stand_in(tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    write_robot("robots/heavy.json", replace(load_talos(), name="heavy", mass=120.0))
    talos, heavy = RecordedRobot.of("talos"), RecordedRobot.of("heavy")
    assert "walked by robot 'talos'; the legs of heavy" in robot_for(talos, "heavy", "p.npz").note
    write_robot("robots/heavy.json", replace(load_talos(), name="heavy", mass=130.0))
    assert "another robot of this name" in robot_for(heavy, None, "p.npz").note
    lower = replace(load_talos(), name="heavy", walking_height=0.8)
    write_robot("robots/heavy.json", lower)
    with pytest.raises(InputError, match="another robot of this name, with its root"):
        robot_for(heavy, None, "p.npz")


@pytest.mark.parametrize(
    ("heights", "says"),
    [
        ([0.95], ""),
        ([0.76, 0.80, 0.77], ""),
        ([1.1, 1.0, 2.5, 2.5, 2.5], ""),  # over a gap whose ground is far below
        ([], ""),
        (
            [0.7, 0.69, 0.6],
            "0.69 m above the ground, where that of talos walks at 0.95 m (that of g1",
        ),
        (
            [1.6, 1.7],
            "1.65 m above the ground, where that of talos walks at 0.95 m: say by --robot",
        ),
    ],
)
def test_the_height_of_the_root_tells_whose_path_it_cannot_be(heights, says) -> None:
    complaint = height_complaint(load_talos(), np.array(heights, np.float64))
    assert says in complaint
    assert bool(complaint) == bool(says)
