"""`jaxleas gait walk`: to the goal, to an abyss, into a fall; logs that plain MuJoCo repeats."""

import json

import numpy as np
import pytest

from jaxleas import cli
from jaxleas.controllers import CONTROLLERS, find_controller
from jaxleas.crossing import NotReachedError, read_walk_log, standing_on
from jaxleas.files import read_npz, write_npz
from jaxleas.footsteps import read_motion_model, shipped_model, write_motion_model
from jaxleas.footsteps.way_left import Strides
from jaxleas.physics import load_body
from jaxleas.terrain import Scene, write_scene
from jaxleas.types import ControllerIdentity, InputError
from tests.terrain.test_scene_edges import rectangle


@pytest.fixture(scope="module")
def scene(tmp_path_factory):
    """A floor that ends at x = 1.2 m."""
    file = tmp_path_factory.mktemp("walk") / "floor.json"
    write_scene(file, Scene({"floor": rectangle(-1.2, 1.2, -1.0, 1.0)}))
    return file


def walk(scene, *options):
    cli.run(["gait", "walk", "--terrain", str(scene), *options])


@pytest.fixture(scope="module")
def log(scene):
    """The log of a walk to a goal half a metre ahead and 10 cm aside."""
    file = scene.parent / "walk.npz"
    walk(scene, "--goal", "0.5,0.1,0", "--log", str(file), "--horizon", "2")
    return file


def test_it_stands_at_the_goal(log):
    made = read_walk_log(log)
    assert made.description.outcome["outcome"] == "reached"
    com = made.footsteps["footstep_com"][-1]
    assert np.hypot(com[0] - 0.5, com[1] - 0.1) < 0.06
    assert made.description.controller.name == "trot"
    assert (made.footsteps["footstep_pair"] == made.footsteps["footstep_expected"]).all()
    landed = np.linalg.norm(
        made.footsteps["footstep_planned"] - made.footsteps["footstep_feet"], axis=2
    )
    assert np.nanmedian(landed) < 0.05
    assert (made.command[-1] == 0.0).all()


def test_plain_mujoco_repeats_a_log(log):
    """Nothing of ours takes part: NumPy reads the file, MuJoCo walks."""
    mujoco = pytest.importorskip("mujoco")
    with np.load(log) as file:
        arrays = dict(file)
    metadata = json.loads(str(arrays["metadata"]))
    model = mujoco.MjModel.from_xml_string(str(arrays["mjcf"]))
    assert model.opt.timestep == metadata["time_step"]
    data = mujoco.MjData(model)
    data.time = arrays["time"][0]
    data.qpos[:], data.qvel[:] = arrays["coordinates"][0], arrays["speeds"][0]
    for step, torques in enumerate(arrays["torques"]):
        if step % metadata["steps_per_tick"] == 0:
            data.qacc_warmstart[:] = 0.0
        data.ctrl[:] = torques
        mujoco.mj_step(model, data)
        np.testing.assert_array_equal(data.qpos, arrays["coordinates"][step + 1])
        np.testing.assert_array_equal(data.qvel, arrays["speeds"][step + 1])
    assert data.qpos[0] > 0.4


def test_a_fall_is_said_and_its_log_kept(scene, tmp_path, capsys):
    file = tmp_path / "fall.npz"
    options = ("--goal", "1.1,0", "--start", "0.6,0", "--blind", "0.8", "--log", str(file))
    with pytest.raises(NotReachedError, match=r"fell at \(") as caught:
        walk(scene, *options)
    assert caught.value.exit_code == 1
    assert "landings less than 1.5 cm from an edge" in capsys.readouterr().out
    outcome = read_walk_log(file).description.outcome
    assert outcome["outcome"] == "fell"
    assert outcome["cause"] in ("tilted", "low")
    assert len(read_walk_log(file).torques) > 100


def test_where_no_command_is_safe_it_stands_and_says_why(tmp_path, capsys):
    islands = {"start": rectangle(-1.0, 0.6, -1.0, 1.0), "goal": rectangle(1.4, 3.0, -1.0, 1.0)}
    write_scene(tmp_path / "islands.json", Scene(islands))
    options = ("--goal", "2.2,0,0", "--start", "0.15,0,0", "--horizon", "2", "--seconds", "12")
    with pytest.raises(NotReachedError, match=r"no path: it stands at|its time was over at \(0\."):
        walk(tmp_path / "islands.json", *options)
    said = capsys.readouterr().out
    assert "landings less than 1.5 cm from an edge: LF 0 of" in said


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--goal", "9,0"), r"the goal \(9, 0\) is outside the map, which has x from"),
        (("--goal", "1.62,0"), r"the goal \(1.62, 0\) is 0.\d+ m away from where a foot may stand"),
        (("--goal", "there"), "--goal is 'there'; give X,Y or X,Y,YAW"),
        (("--goal", "1,0", "--start", "1.0,0"), "no ground under foot LF"),
        (("--goal", "1,0", "--start", "0.82,0"), r"foot LF starts on an unsafe cell at .*nearest"),
        (("--goal", "1,0", "--log", "walk.zip"), "walk.zip: the name of a log must end in .npz"),
        (("--goal", "1,0", "--seconds", "0"), "a walk of 0 s: give more than 0 s"),
        (("--goal", "1,0", "--shift", "-1"), "shift -1 m"),
        (("--goal", "1,0", "--blind", "0"), "blind"),
        (("--goal", "1,0", "--higher", "trot_high", "--blind", "0.4"), "--higher chooses a contr"),
        (("--goal", "1,0", "--higher", "trot_low"), "no controller 'trot_low'|trot_low"),
    ],
)
def test_what_cannot_be_walked_is_refused(scene, options, message):
    with pytest.raises(InputError, match=message):
        walk(scene, *options)


def test_feet_that_would_hang_in_the_air_are_refused():
    surfaces = {"high": rectangle(-1.0, 0.3, -1.0, 1.0), "low": rectangle(0.3, 2.0, -1.0, 1.0)}
    surfaces["low"] = surfaces["low"] - np.array([0.0, 0.0, 0.18])
    message = r"ground under foot LF at .* 18 cm below that of another foot"
    with pytest.raises(InputError, match=message):
        standing_on(Scene(surfaces), load_body("anymal_b"), [(0.0, 0.0, 0.0)])


def test_a_controller_without_shipped_models_is_told_how_to_make_them():
    identity = ControllerIdentity("amble", "anymal_b", ("LF",), ((0,),), 0.065, 0.031, (1.0, 0, 0))
    with pytest.raises(InputError, match=r"no motion models of controller amble on anymal_b: make"):
        shipped_model(identity)


@pytest.mark.parametrize("name", CONTROLLERS)
def test_models_of_every_controller_are_shipped_and_answer_for_it(name):
    identity = find_controller(name, load_body("anymal_b")).identity
    model = shipped_model(identity)
    assert model.controller == identity
    assert len(model.commands()) == 51
    assert model.errors.landing["0.95"] < 0.02  # of the trot 1.5 cm
    assert 0.15 < Strides.of(model, model.commands()).ahead < 0.40


@pytest.mark.slow
def test_another_controller_walks_on_its_own_models(scene, tmp_path):
    file = tmp_path / "quick.npz"
    options = ("--controller", "trot_quick", "--horizon", "2", "--log", str(file))
    walk(scene, "--goal", "0.4,0,0", *options)
    made = read_walk_log(file)
    assert made.description.controller.name == "trot_quick"
    landed = made.footsteps["footstep_planned"] - made.footsteps["footstep_feet"]
    assert np.nanmedian(np.linalg.norm(landed[..., :2], axis=2)) < 0.03


@pytest.mark.slow
def test_high_swings_take_over_where_the_low_ones_clear_no_step(tmp_path):
    steps = {
        "floor": rectangle(-1.2, 1.0, -1.0, 1.0),
        "step": rectangle(1.0, 3.0, -1.0, 1.0, 0.08),
    }
    write_scene(tmp_path / "step.json", Scene(steps))
    file = tmp_path / "walk.npz"
    options = ("--higher", "trot_high", "--seconds", "30", "--log", str(file))
    walk(tmp_path / "step.json", "--goal", "1.9,0,0", *options)
    made = read_walk_log(file)
    assert made.description.controller.name == "trot or trot_high"
    walked_by = made.footsteps["footstep_controller"]
    assert set(walked_by) == {"trot", "trot_high"}
    high = made.footsteps["footstep_feet"][:, :, 2] > 0.06
    climbs = np.diff(high.sum(axis=1), prepend=0) > 0
    assert (walked_by[climbs] == "trot_high").all()
    assert high[-1].all()


def test_models_of_another_controller_are_refused(scene, tmp_path):
    from dataclasses import replace

    model = shipped_model(find_controller("trot", load_body("anymal_b")).identity)
    other = replace(model, controller=replace(model.controller, swing_height=0.1))
    write_motion_model(tmp_path / "other.npz", other)
    assert read_motion_model(tmp_path / "other.npz").controller.swing_height == 0.1
    with pytest.raises(InputError, match=r"other.npz is of another controller .*swing_height: 0.1"):
        walk(scene, "--goal", "1,0", "--models", str(tmp_path / "other.npz"))


def test_a_cut_log_is_refused(log, tmp_path):
    arrays = read_npz(log, ())
    arrays["speeds"] = arrays["speeds"][:-1]
    write_npz(tmp_path / "cut.npz", **arrays)
    with pytest.raises(InputError, match=r"cut.npz: speeds has \d+ rows; \d+ physics steps have"):
        read_walk_log(tmp_path / "cut.npz")
