"""A quadruped on the page, without a browser: sent, sent elsewhere, stopped, fallen, recorded."""

import contextlib
import signal
import subprocess
import sys
import threading
import time
from importlib.resources import as_file, files

import numpy as np
import pytest

from jaxleas.footsteps import Goal, ProposedPlanner
from jaxleas.terrain import READING, Scene, write_scene
from jaxleas.types import InputError
from tests.terrain.test_scene_edges import rectangle
from tests.viewer.test_commands import messages

pytest.importorskip("mujoco")

from jaxleas.viewer.commands import view
from jaxleas.viewer.legged_view import Quadruped
from jaxleas.viewer.live_walk import LiveWalk
from jaxleas.viewer.walker_options import WalkerOptions

FRAME = 1.0 / 32.0


@pytest.fixture(scope="module")
def floor(tmp_path_factory):
    """A floor that ends at x = 1.4 m."""
    file = tmp_path_factory.mktemp("live") / "floor.json"
    write_scene(file, Scene({"floor": rectangle(-1.2, 1.4, -1.0, 1.0)}))
    return file


@pytest.fixture(scope="module")
def made(floor):
    return Quadruped(floor, READING, WalkerOptions("trot"))


@contextlib.contextmanager
def live(made, planner=None):
    walk = LiveWalk(made.walk, made.start, planner or made.planner)
    try:
        yield walk
    finally:
        walk.close()
    assert "quadruped" not in {each.name for each in threading.enumerate()}


def walked(walk, seconds):
    """Let it walk, and return when it stands, or after a time."""
    for _ in range(round(seconds / FRAME)):
        walk.advance(FRAME, waits=True)
        if not walk.busy:
            break
    return walk.snapshot


def test_it_walks_where_it_is_sent_and_then_elsewhere(made):
    with live(made) as walk:
        assert walk.snapshot.state == "waiting"
        walk.send(Goal(0.5, 0.0, speed=0.25))
        first = walked(walk, 0.5)
        assert first.state == "walking"
        assert first.seconds == pytest.approx(0.5, abs=0.05)  # the page owns the clock
        walk.send(Goal(0.25, 0.0, speed=0.25))
        there = walked(walk, 10.0)
        assert there.state == "arrived"
        assert abs(there.coordinates[0] - 0.25) < 0.08
        walk.send(Goal(0.5, 0.0, speed=0.25))
        walked(walk, 0.4)
        walk.stop()
        stopped = walked(walk, 5.0)
        assert stopped.state == "arrived"
        walk.reset()
        walked(walk, 1.0)
        np.testing.assert_array_equal(walk.snapshot.coordinates, made.start.coordinates[0])
        assert walk.snapshot.seconds == 0.0


class Ahead:
    """A planner that always goes ahead, as fast as it can."""

    def plan(self, state, goal):
        from jaxleas.footsteps import FootstepPlan, PlannedFootstep

        command = np.array([1.0, 0.0, 0.0])
        step = PlannedFootstep(state.pair, command, state.com[:2], state.yaw, state.feet)
        return FootstepPlan("horizon", (step,), 0.0, 0.0, 1)


def test_a_robot_that_fell_lies_until_it_is_put_back(made):
    with live(made, Ahead()) as walk:
        walk.send(Goal(5.0, 0.0))
        assert walked(walk, 8.0).state == "fell"
        walk.send(Goal(0.2, 0.0))
        assert walked(walk, 0.5).state == "fell"
        walk.reset()
        assert walked(walk, 0.5).state == "waiting"


def test_what_a_planner_refuses_is_said(made):
    with live(made) as walk:
        walk.send(Goal(50.0, 0.0))
        found = walked(walk, 2.0)
        assert found.state == "failed"
        assert "outside the map" in found.why


def test_a_start_without_room_is_refused(floor):
    for start in ((1.35, 0.0, 0.0), (9.0, 0.0, 0.0)):
        with pytest.raises(InputError, match=r"no ground under foot"):
            Quadruped(floor, READING, WalkerOptions("trot", start))
    turned = Quadruped(floor, READING, WalkerOptions("trot", (0.1, 0.0, 90.0)))
    w, _, _, z = turned.start.coordinates[0, 3:7]
    assert 2.0 * np.arctan2(z, w) == pytest.approx(np.pi / 2)


def test_a_walk_is_recorded(floor, tmp_path):
    pytest.importorskip("viser")
    page = tmp_path / "walk.html"
    view(floor, controller="trot", goal=(0.98, 0.0), start=(0.73, 0.0, 0.0), record=page)
    seconds, shown = messages(page.read_text(encoding="utf-8"))
    assert seconds > 0.5
    roots = [
        message["position"]
        for _, message in shown
        if message["type"] == "SetPositionMessage" and message["name"] == "/walker/base"
    ]
    assert roots[-1][0] == pytest.approx(0.98, abs=0.08)
    # A front foot that comes within 7 cm of the end of the floor is no longer green.
    green = [
        message["visible"]
        for _, message in shown
        if message["type"] == "SetSceneNodeVisibilityMessage" and "LF_green" in message["name"]
    ]
    assert False in green


def test_what_is_no_quadruped_is_refused(floor, tmp_path):
    with pytest.raises(InputError, match="--record with a robot needs --goal"):
        view(floor, controller="trot", record=tmp_path / "a.html")
    with pytest.raises(InputError, match="amble"):
        view(floor, controller="amble", goal=(0.5, 0.0), record=tmp_path / "a.html")
    with pytest.raises(InputError, match=r"no robot 'talos' for physics, only anymal_b"):
        view(floor, controller="trot", robot="talos", goal=(0.5, 0.0), record=tmp_path / "a.html")
    with pytest.raises(InputError, match="--proposal needs --controller"):
        view(floor, proposal="shipped")


def test_a_proposal_and_models_of_its_own_controller_are_used(floor):
    shipped = files("jaxleas.footsteps") / "data"
    made = Quadruped(floor, READING, WalkerOptions("trot", proposal="shipped"))
    assert isinstance(made.planner, ProposedPlanner)
    with as_file(shipped / "trot_quick_anymal_b.npz") as models:
        other = WalkerOptions("trot", models=models)
        with pytest.raises(InputError, match="trot_quick"):
            Quadruped(floor, READING, other)
        quick = WalkerOptions("trot_quick", models=models, proposal="shipped")
        with pytest.raises(InputError, match="no proposal for controller trot_quick"):
            Quadruped(floor, READING, quick)


@pytest.mark.slow
def test_ctrl_c_ends_a_live_walk_quietly(floor):
    pytest.importorskip("viser")
    options = ["--controller", "trot", "--goal", "0.9", "0", "--port", "0"]
    command = [sys.executable, "-m", "jaxleas.cli", "view", str(floor), *options]
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None
        assert "Ctrl-C ends" in process.stdout.readline()
        time.sleep(5.0)  # until it walks; sooner, too, it would end quietly
        process.send_signal(signal.SIGINT)
        out, errors = process.communicate(timeout=60)
    assert (process.returncode, out.strip(), errors) == (0, "", "")
