import json
from dataclasses import replace

import numpy as np
import pytest

from jaxleas import cli
from jaxleas.files import read_npz, write_json, write_npz
from jaxleas.footsteps import read_motion_model, write_footsteps
from jaxleas.terrain import HeightMap, write_height_map
from jaxleas.types import InputError
from tests.footsteps.made import IDENTITY, NOMINAL, walked


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A folder with two files of footsteps, and what `gait fit` makes of them."""
    folder = tmp_path_factory.mktemp("gait")
    for seed in (0, 1):
        records = walked(runs=10, steps=60, noise=0.002, seed=seed)
        write_footsteps(folder / f"steps_{seed}.npz", records)
    files = [str(folder / f"steps_{seed}.npz") for seed in (0, 1)]
    cli.run(["gait", "fit", *files, "--out", str(folder / "fit"), "--no-network"])
    return folder


def test_a_fit_leaves_models_report_scores_and_pictures(folder):
    fit = folder / "fit"
    model = read_motion_model(fit / "model.npz")
    assert model.controller == IDENTITY
    assert [each["file"] for each in model.provenance["footsteps"]] == [
        str(folder / f"steps_{seed}.npz") for seed in (0, 1)
    ]
    report = (fit / "report.md").read_text()
    for table in ("5.1", "5.2", "5.3", "5.4", "5.5", "5.6", "5.7"):
        assert f"## Table {table}" in report
    assert "| x | 97.0 / 3.81 |" in report
    assert "Not kept: 6 apex too low." in report
    scores = json.loads((fit / "scores.json").read_text())["scores"]
    kept = [each for each in scores if each["predictors"] == "C4" and each["movement"] == "all"]
    # Two splits of 6 numbers of the centre of mass and 8 of feet in two ways.
    assert len([each for each in kept if each["model"] == "linear"]) == 2 * (6 + 16)
    movements = ("forward", "left", "right", "clockwise", "counter-clockwise")
    assert all((fit / f"{name}.png").stat().st_size > 5000 for name in movements)


def test_footsteps_of_two_controllers_are_not_fitted_together(folder, tmp_path):
    other = replace(walked(runs=5, steps=8), controller=replace(IDENTITY, swing_height=0.1))
    write_footsteps(tmp_path / "other.npz", other)
    files = [str(folder / "steps_0.npz"), str(tmp_path / "other.npz")]
    with pytest.raises(InputError, match=r"other.npz is of another controller .*swing_height: 0.1"):
        cli.run(["gait", "fit", *files, "--out", str(tmp_path / "fit")])
    assert not (tmp_path / "fit").exists()


def test_footsteps_of_two_definitions_are_not_fitted_together(folder, tmp_path):
    write_footsteps(tmp_path / "other.npz", replace(walked(5, 8), definition="thesis"))
    files = [str(folder / "steps_0.npz"), str(tmp_path / "other.npz")]
    with pytest.raises(InputError, match=r"other.npz holds footsteps by the definition 'thesis'"):
        cli.run(["gait", "fit", *files, "--out", str(tmp_path / "fit")])


def test_a_model_of_another_version_is_refused(folder, tmp_path):
    arrays = read_npz(folder / "fit/model.npz", ())
    write_npz(tmp_path / "cut.npz", **{k: v for k, v in arrays.items() if k != "weights_1"})
    with pytest.raises(InputError, match=r"cut.npz lacks the array weights_1"):
        read_motion_model(tmp_path / "cut.npz")
    arrays["weights_0"] = arrays["weights_0"][:-1]
    write_npz(tmp_path / "cut.npz", **arrays)
    with pytest.raises(InputError, match=r"cut.npz: weights of shape \(18, 11\) where"):
        read_motion_model(tmp_path / "cut.npz")


STATE = {
    "controller": "made up",
    "robot": "probe",
    "com": [0.0, 0.0, 0.45],
    "yaw": 0.0,
    "feet": {
        name: [x, y, 0.0] for name, (x, y) in zip(IDENTITY.feet, NOMINAL.tolist(), strict=True)
    },
    "next_foot": "LF",
}


@pytest.fixture
def world(folder, tmp_path):
    """Options of `gait footsteps` on flat ground."""
    flat = HeightMap(np.zeros((100, 200), np.float32), 0.02, (-1.0, -1.0))
    write_height_map(tmp_path / "flat.npz", flat)
    write_json(tmp_path / "state.json", STATE)
    return [
        *(
            "gait",
            "footsteps",
            str(tmp_path / "flat.npz"),
            "--models",
            str(folder / "fit/model.npz"),
        ),
        *("--state", str(tmp_path / "state.json"), "--out", str(tmp_path / "plan.json")),
    ]


@pytest.mark.parametrize("controller", ["trot", "trot_high", "trot_quick"])
def test_models_of_the_package_are_taken_for_the_controller_of_the_state(
    world, tmp_path, controller
):
    write_json(tmp_path / "state.json", STATE | {"controller": controller, "robot": "anymal_b"})
    shipped = [each for each in world if each != "--models" and not each.endswith("model.npz")]
    cli.run([*shipped, "--goal", "1.5,0,0"])
    assert len(json.loads((tmp_path / "plan.json").read_text())["footsteps"]) == 2


def test_a_controller_of_which_none_are_shipped_is_said(world, tmp_path):
    shipped = [each for each in world if each != "--models" and not each.endswith("model.npz")]
    with pytest.raises(InputError, match="no motion models of controller made up on probe"):
        cli.run([*shipped, "--goal", "1.5,0,0"])


def test_a_plan_is_written_and_said(world, tmp_path, capsys):
    cli.run([*world, "--goal", "1.5,0,0", "--picture", str(tmp_path / "costs.png")])
    written = json.loads((tmp_path / "plan.json").read_text())
    assert written["status"] == "horizon"
    assert [each["swinging"] for each in written["footsteps"]] == [["LF", "RH"], ["RF", "LH"]]
    assert written["command"] == written["footsteps"][0]["command"] == pytest.approx([0.8, 0, 0])
    assert (tmp_path / "costs.png").exists()
    assert "2 footsteps to the horizon" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("change", "goal", "message"),
    [
        ({"robot": "anymal_b"}, "1,0", "robot is 'anymal_b', but the motion models are of 'probe'"),
        ({"controller": "trot"}, "1,0", "controller is 'trot', but"),
        ({"next_foot": "tail"}, "1,0", "next_foot is 'tail'; give one of LF, RF, LH, RH"),
        ({"feet": {"LF": [0.0, 0.0, 0.0]}}, "1,0", "feet has LF; probe has LF, RF, LH, RH"),
        ({"com": [0.0, 0.0]}, "1,0", "is no walking state: com"),
        ({}, "12,0", "outside the map, which has x from -1.01 to 2.99"),
        ({}, "there", "--goal is 'there'; give X,Y or X,Y,YAW"),
    ],
)
def test_what_cannot_be_planned_is_refused(world, tmp_path, change, goal, message):
    write_json(tmp_path / "state.json", STATE | change)
    with pytest.raises(InputError, match=message):
        cli.run([*world, "--goal", goal])
    assert not (tmp_path / "plan.json").exists()
