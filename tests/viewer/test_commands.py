import base64
import builtins
import re
import signal
import socket
import subprocess
import sys
import urllib.request

import numpy as np
import pytest

from jaxleas.guide import write_guide_paths
from jaxleas.terrain import transition, write_height_map, write_scene
from jaxleas.training.policy import write_policy
from jaxleas.types import InputError
from jaxleas.viewer import server as viewer_server
from jaxleas.viewer.commands import view
from jaxleas.viewer.policy_robots import names_of
from jaxleas.viewer.server import from_elsewhere, open_browser, serving
from tests.guide.walkers import flat_map, random_policy
from tests.viewer.test_clips import straight


@pytest.fixture
def terrain(tmp_path):
    write_height_map(tmp_path / "flat.npz", flat_map())
    return tmp_path / "flat.npz"


def embedded(page: str) -> bytes:
    """The recording inside a page."""
    found = re.search(r'__VISER_EMBED_DATA__="([^"]+)"', page)
    assert found
    return base64.b64decode(found[1])


def messages(page: str) -> tuple[float, list]:
    """Duration [s] and messages of a recording."""
    msgspec, zstandard = pytest.importorskip("msgspec"), pytest.importorskip("zstandard")
    packed = embedded(page)
    inner = zstandard.ZstdDecompressor().decompress(packed[8:])
    size = int.from_bytes(inner[:8], "little")
    content = msgspec.msgpack.decode(inner[8 : 8 + size])
    return content["durationSeconds"], content["messages"]


def test_a_walk_is_recorded_into_one_file(terrain, tmp_path, capsys):
    pytest.importorskip("viser")
    write_policy(tmp_path / "policy.npz", random_policy(seed=4))
    page = tmp_path / "walk.html"
    view(terrain, policies=[tmp_path / "policy.npz"], goal=(0.9, 0.0), start=(0, 0, 0), record=page)
    assert "opens in any browser" in capsys.readouterr().out
    content = page.read_text(encoding="utf-8")
    assert not re.search(r'<(?:script|link)[^>]+(?:src|href)="?https?:', content)
    seconds, shown = messages(content)
    assert seconds > 0.1
    names = {message.get("name") for _, message in shown}
    assert {"/terrain", "/robot_0", "/robot_0/reach_left", "/robot_0/seen", "/goal"} <= names
    moved = [
        m["position"]
        for t, m in shown
        if m["type"] == "SetPositionMessage" and m["name"] == "/robot_0"
    ]
    assert len(moved) > 3
    assert np.ptp(np.array(moved), axis=0).max() > 1e-3


def test_a_guide_path_is_recorded_from_beginning_to_end(tmp_path):
    pytest.importorskip("viser")
    write_scene(tmp_path / "stairs.json", transition("stairs_up", 3).scene)
    write_guide_paths(tmp_path / "paths.npz", [straight()], ["invalid"])
    page = tmp_path / "guide.html"
    view(tmp_path / "stairs.json", guide=tmp_path / "paths.npz", record=page)
    seconds, shown = messages(page.read_text(encoding="utf-8"))
    assert seconds == pytest.approx(0.8 / 4.0, abs=0.08)  # at four times the speed
    moved = [
        m["position"]
        for t, m in shown
        if m["type"] == "SetPositionMessage" and m["name"] == "/played"
    ]
    assert moved[-1] == pytest.approx([0.8, 0.0, 0.95])


def test_bad_input_is_one_sentence(terrain, tmp_path):
    for given, says in (
        ({"plan": tmp_path / "plan.json"}, "belong together"),
        ({"record": tmp_path / "a.mp4"}, "written as .html"),
        ({"record": tmp_path / "a.html"}, "something that moves"),
        ({"record": tmp_path / "a.html", "policies": [terrain]}, "--goal"),
        ({"goal": (np.nan, 0.0), "policies": [terrain]}, "--goal nan 0: give finite numbers"),
        ({"goal": (1.0, 0.0)}, "--goal needs --policies or --controller"),
        ({"start": (1.0, 0.0, 0.0)}, "--start needs --policies or --controller"),
        ({"start": (1e9, 0.0, 0.0), "policies": [terrain]}, "--start 1e+09 0 0: give finite"),
        ({"policies": [tmp_path / "nobody"]}, "there is no"),
        ({"guide": terrain}, "lacks the array"),
        ({"port": 70_000}, "no port"),
    ):
        with pytest.raises(InputError, match=re.escape(says)):
            view(terrain, **given)
    assert not (tmp_path / "a.html").exists()


def test_a_port_in_use_is_refused(terrain):
    pytest.importorskip("viser")
    with socket.create_server(("127.0.0.1", 0)) as other:
        port = other.getsockname()[1]
        with pytest.raises(InputError, match=f"port {port} of 127.0.0.1 is in use"):
            view(terrain, port=port)
    for host in ("192.0.2.1", "a" * 80):  # an address for documentation, nobody's; and no name
        with pytest.raises(InputError, match="cannot listen on"):
            view(terrain, host=host)


def test_without_viser_it_says_what_to_install(terrain, monkeypatch):
    real = builtins.__import__

    def without(name, *rest, **options):
        if name.split(".")[0] == "viser":
            raise ImportError(name)
        return real(name, *rest, **options)

    monkeypatch.setattr(builtins, "__import__", without)
    with pytest.raises(InputError, match=re.escape("pip install 'jaxleas[view]'")):
        view(terrain)


def test_the_ground_is_shown_before_jax_is_loaded():
    files = (
        "terrain.importers",
        "viewer.commands",
        "viewer.ground",
        "viewer.show",
        "viewer.server",
    )
    code = "import sys, " + ", ".join(f"jaxleas.{file}" for file in files)
    code += "; assert not {'jax', 'flax', 'scipy', 'trimesh'} & sys.modules.keys()"
    subprocess.run([sys.executable, "-c", code], check=True)


def test_policies_of_one_run_are_told_apart(tmp_path):
    run = tmp_path / "run"
    both = [run / "policy.npz", run / "policy.onnx"]
    assert names_of([run]) == ["run"] == names_of(both[:1])
    assert names_of([*both, tmp_path / "other.onnx"]) == [
        "run/policy.npz",
        "run/policy.onnx",
        "other",
    ]


def test_without_a_display_no_browser_is_opened(monkeypatch):
    monkeypatch.setattr(viewer_server.sys, "platform", "linux")
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(viewer_server.webbrowser, "open", lambda _: pytest.fail("opened"))
    assert not open_browser("http://127.0.0.1:8080")


@pytest.mark.parametrize(
    ("host", "says"),
    [
        ("127.0.0.1", "ssh -L 80:127.0.0.1:80 "),
        ("localhost", "ssh -L 80:localhost:80 "),
        ("::1", "ssh -L 80:[::1]:80 "),
        ("0.0.0.0", "no password"),
        ("192.0.2.1", "no password"),
    ],
)
def test_it_says_how_other_machines_reach_it(host, says):
    assert says in from_elsewhere(host, 80)


def test_it_listens_on_the_loopback_interface_alone():
    pytest.importorskip("viser")
    with serving("127.0.0.1", 0) as server:
        listening = server.get_host(), server.get_port()
        assert server.request_share_url() is None
        with urllib.request.urlopen("http://{}:{}".format(*listening)) as page:
            assert page.status == 200
        with pytest.raises(ConnectionRefusedError):
            socket.create_connection(("127.0.0.2", listening[1]), timeout=5).close()
    with pytest.raises(ConnectionRefusedError):
        socket.create_connection(listening, timeout=5).close()


def test_ctrl_c_ends_quietly(terrain):
    pytest.importorskip("viser")
    command = [sys.executable, "-m", "jaxleas.cli", "view", str(terrain), "--port", "0"]
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None
        said = [process.stdout.readline(), process.stdout.readline()]
        process.send_signal(signal.SIGINT)
        out, errors = process.communicate(timeout=60)
    assert process.returncode == 0
    assert "1 surface, " in said[0]
    assert "Ctrl-C ends" in said[1]
    assert (out.strip(), errors) == ("", "")


def test_the_surfaces_found_in_a_map_are_shown(terrain, tmp_path, capsys):
    pytest.importorskip("viser")
    write_guide_paths(tmp_path / "guide.npz", [straight()], ["reached"])
    for option, shown in (({}, True), ({"surfaces": False}, False)):
        page = tmp_path / "walk.html"
        view(terrain, guide=tmp_path / "guide.npz", record=page, **option)
        assert ("1 surface, " in capsys.readouterr().out) is shown
        _, sent = messages(page.read_text(encoding="utf-8"))
        names = {message.get("name") for _, message in sent}
        assert ({"/surfaces", "/edges"} <= names) is shown
