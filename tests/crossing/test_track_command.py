"""`jaxleas gait track`: plans followed in physics, those that cannot be, and logs."""

import json

import pytest

from jaxleas import cli
from jaxleas.crossing import NotFollowedError, read_walk_log
from jaxleas.gaits import write_gait_plan
from jaxleas.terrain import Scene, write_scene
from jaxleas.types import InputError
from tests.controllers.tracks import one_step
from tests.terrain.test_scene_edges import rectangle

UP = 0.06
"""Height of the step, onto which the left hind foot steps [m]."""


@pytest.fixture
def files(tmp_path):
    """A floor with a low block where the left hind foot is to land, and a plan onto it."""
    block = rectangle(-0.28, -0.1, 0.1, 0.3, UP)
    write_scene(tmp_path / "step.json", Scene({"floor": rectangle(-1, 1, -1, 1), "block": block}))
    write_gait_plan(tmp_path / "plan.json", one_step(rise=UP), {})
    return tmp_path


def track(files, *options):
    plan, terrain = str(files / "plan.json"), str(files / "step.json")
    cli.run(["gait", "track", plan, "--terrain", terrain, *options])


def test_a_step_up_is_followed_to_its_end_and_logged(files, capsys):
    track(files, "--log", str(files / "log.npz"))
    said = capsys.readouterr().out
    assert "followed to the end of the plan" in said
    assert "1 of 1 footholds within 5 cm" in said
    log = read_walk_log(files / "log.npz")
    assert log.description.controller.name == "tracker"
    assert log.description.outcome["fts"] == 1.0
    assert log.description.outcome["fter"] < 0.02
    assert len(log.torques) > 1000


def test_a_plan_that_is_not_followed_is_an_answer(files):
    with pytest.raises(NotFollowedError, match="its time was over, after 0") as caught:
        track(files, "--seconds", "0.2")
    assert caught.value.exit_code == 1


def edited(files, change):
    content = json.loads((files / "plan.json").read_text())
    change(content)
    (files / "plan.json").write_text(json.dumps(content))


def _lifted(content):
    for phase in content["phases"]:
        phase["feet"]["RF"][2] += 0.1


def _on_three(content):
    content["phases"][0]["contacts"].remove("LF")


def _far(content):
    for phase in content["phases"]:
        phase["feet"]["RF"][0] += 0.5


def _outside(content):
    for phase in content["phases"]:
        phase["feet"]["RF"][0] += 5.0


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (_lifted, "foot RF of phase 0 at .* is 10 cm above the ground: is it for another terrain"),
        (_outside, "no ground is under foot RF of phase 0"),
        (_on_three, "first phase has a foot in the air"),
        (_far, "cannot stand as the plan begins: its foot RF stays"),
    ],
)
def test_plans_for_something_else_are_refused(files, change, message):
    edited(files, change)
    with pytest.raises(InputError, match=message):
        track(files)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--log", "log.txt"], "must end in .npz"),
        (["--speed", "0.5"], "--speed 0.5"),
        (["--seconds", "0"], "--seconds 0"),
    ],
)
def test_bad_options_are_refused(files, options, message):
    with pytest.raises(InputError, match=message):
        track(files, *options)
