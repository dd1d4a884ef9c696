"""Every command of the documentation is run, or says on the page why it is not.

A page's blocks of sh, and its python blocks, are run from top to bottom in a folder that holds what
they name: `stock` makes it. What a block leaves is there for the blocks after it. Three ways to
write a block:

    ```sh                                   it is run: small, see SMALL; training is replayed
    ```sh title="not run by the tests: an hour"     it is not; its reader sees why
    <!-- file: NAME -->                     before a block: it is saved under this name

A python block needs `<!-- runs -->` before it, or such a title. A new command whose files are not
in `stock` fails: add the files there, or the title to the block.
"""

import contextlib
import functools
import re
import shlex
import shutil
from collections.abc import Iterator
from dataclasses import dataclass, replace
from importlib import import_module
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import trimesh
from PIL import Image

from jaxleas import cli
from jaxleas.contacts import Stepping, problem_from_guide
from jaxleas.contacts.problem_file import write_problem
from jaxleas.files import write_json
from jaxleas.guide.files import write_guide_paths
from jaxleas.robots import load_talos, write_robot
from jaxleas.terrain import Scene, write_height_map
from jaxleas.terrain.scene_file import write_scene
from jaxleas.training.policy import read_policy, write_policy
from tests.contacts.sampling.worlds import straight
from tests.guide.walkers import flat_map, homing_policy
from tests.records.folders import make_run
from tests.test_docs import PAGES, ROOT, name_of

BLOCK = re.compile(
    r'^(?:<!-- (?P<mark>[^\n]*) -->\n)?```(?P<language>\w*)(?: title="(?P<title>[^"\n]*)")?\n'
    r"(?P<body>.*?)^```$",
    re.MULTILINE | re.DOTALL,
)
NOT_RUN = "not run by the tests: "
AS_WELL = "not run here: "  # likewise
# Options that make a command small, by command; what it was given is first checked as it stands.
SMALL = {
    "evaluate": {"starts": 2, "processes": 1},
    "rollout": {"steps": 40},
    "navigate": {"limit": 10.0},
    "label": {"processes": 1},
}
SAVED = ("json", "yaml", "python")
QUERY = {"position": [0.5, 1.0, 0.95], "yaw": 0.0, "velocity": [0, 0, 0], "goal": [4.5, 1.0]}


@dataclass(frozen=True)
class Block:
    """A fenced block; `mark` is the comment before it, `title` what its reader sees above it."""

    language: str
    mark: str
    title: str
    body: str

    @property
    def commands(self) -> list[str]:
        joined = self.body.replace("\\\n", " ").splitlines()
        return [line for line in joined if shlex.split(line, comments=True)]


def blocks(page: Path) -> Iterator[Block]:
    for found in BLOCK.finditer(page.read_text(encoding="utf-8")):
        named = {key: value or "" for key, value in found.groupdict().items()}
        yield Block(named["language"], named["mark"], named["title"], named["body"])


ALL = [(page, block) for page in PAGES for block in blocks(page)]


@pytest.mark.parametrize(
    ("page", "block"), ALL, ids=[f"{name_of(page)}-{n}" for n, (page, _) in enumerate(ALL)]
)
def test_every_block_is_run_or_says_why_not(page: Path, block: Block) -> None:
    if block.title:
        assert block.title.startswith((NOT_RUN, AS_WELL)), "a title says why a block is not run"
        assert len(block.title.partition(": ")[2]) > 3, "say why"
    if block.language == "python" and not block.title:
        assert block.mark.startswith(("runs", "file: ")), f"{page}: mark this block:\n{block.body}"
    if block.mark.startswith("file: "):
        assert block.language in SAVED


def test_no_command_hides_in_another_block() -> None:
    """Only blocks of sh can say that they are not run."""
    command = re.compile(r"^(?: {4})?(?:python|jaxleas|make) .*$", re.MULTILINE)
    for page in PAGES:
        indented = BLOCK.sub("", page.read_text(encoding="utf-8"))
        assert not re.findall(r"^ {4}(?:python|jaxleas|make) .*$", indented, re.MULTILINE), page
        for block in blocks(page):
            assert block.language == "sh" or not command.search(block.body), page


@pytest.fixture(scope="module")
def stock(tmp_path_factory) -> Path:
    """What the pages name: runs, terrains, guide paths, problems. Made once; pages get copies."""
    folder = tmp_path_factory.mktemp("docs")
    with contextlib.chdir(folder):
        _fill_here()
    return folder


@pytest.fixture
def workplace(stock: Path, tmp_path: Path, monkeypatch) -> Path:
    shutil.copytree(stock, tmp_path / "work")
    monkeypatch.chdir(tmp_path / "work")
    monkeypatch.syspath_prepend(str(ROOT))
    return tmp_path / "work"


def _fill_here() -> None:
    floor = np.array([[-2.0, -2, 0], [20, -2, 0], [20, 10, 0], [-2, 10, 0]])
    scene = Scene({"floor": floor})
    guides = [straight(1.2), straight(2.0, y=1.0)]
    for name in ("scene", "SCENE"):
        write_scene(f"{name}.json", scene)
    for name, count in (("guide", 1), ("GUIDE", 1), ("guides", 2), ("paths", 2)):
        write_guide_paths(f"{name}.npz", guides[:count], ["reached"] * count)
    for name in ("problem", "PROBLEM"):
        write_problem(
            f"{name}.json", problem_from_guide(guides[0], scene, "talos", Stepping(every=14))
        )
    slab = trimesh.creation.box((22.0, 12.0, 0.2))
    slab.apply_translation((9.0, 4.0, -0.1))
    for name in ("my_terrain", "hall", "arena"):
        slab.export(f"{name}.stl")
    part = slab.copy()
    part.vertices = 1000.0 * part.vertices[:, [1, 2, 0]]  # millimetres, y up
    part.export("part.obj")
    Image.fromarray(np.full((60, 80), 20_000, np.uint16)).save("dem.png")
    for name in ("terrain", "map"):
        write_height_map(f"{name}.npz", flat_map(half_size=6.0))
    write_json("queries.json", [QUERY])
    write_robot("robots/walker.json", replace(load_talos(), name="walker"), about="a test")
    for name in ("leas_p1", "another", "leas_p2_sampling", "p2_mip"):
        run = make_run(Path("runs") / name, seed=len(name))
        write_policy(run / "policy.npz", homing_policy())
    for name in ("configs", "pretrained"):
        shutil.copytree(ROOT / name, name)


class Runner:
    """Runs commands in this process; a training is replayed: its folder is filled at once."""

    def __init__(self, monkeypatch) -> None:
        self.ran = 0
        self._patch = monkeypatch
        monkeypatch.setattr("jaxleas.training.train_task", self._replay)
        # Judging, export and report after it are commands of their own.
        monkeypatch.setattr("jaxleas.train_command._conclude", lambda config, run, allow: None)

    def sh(self, line: str) -> None:
        self.ran += 1
        match shlex.split(line, comments=True):
            case ["jaxleas", "train", *arguments] | ["python", "train.py", *arguments]:
                self._train(arguments)
            case ["jaxleas", *arguments]:
                self._jaxleas(arguments)
            case _:
                pytest.fail(f"this test cannot run {line!r}: give its block a title, {NOT_RUN!r}")

    @staticmethod
    def _train(arguments: list[str]) -> None:
        run_train = import_module("train").main
        match arguments:
            case ["--resume", run, *_]:
                assert (Path(run) / "config.yaml").is_file(), f"{arguments}: no such run"
                run_train(arguments)
            case [_, *options] if "--help" in options:
                with pytest.raises(SystemExit):
                    run_train(arguments)
            case _:
                run_train(arguments)
                for dated in Path("runs").glob("*_20??-*"):  # the next may come in the same second
                    shutil.rmtree(dated)

    def _jaxleas(self, arguments: list[str]) -> None:
        words = [" ".join(arguments[:2]), arguments[0]]
        name = next(each for each in words if each in cli.COMMANDS)
        module, function_name, _ = cli.COMMANDS[name]
        function = getattr(import_module(module), function_name)

        @functools.wraps(function)
        def small(**given):
            return function(**{**given, **SMALL.get(name, {})})

        with self._patch.context() as patch:
            patch.setattr(cli, "import_module", lambda _: SimpleNamespace(**{function_name: small}))
            cli.run(arguments)

    @staticmethod
    def _replay(config, task, run, *_):
        policy = homing_policy()
        write_policy(run.path / "policy.npz", policy)
        return policy


RUN = [page for page, block in ALL if not block.title and (block.language == "sh" or block.mark)]


LONG = {"evaluation.md"}  # pages whose commands take half a minute
RUN_PAGES = [
    pytest.param(page, marks=[pytest.mark.slow] if page.name in LONG else [], id=name_of(page))
    for page in dict.fromkeys(RUN)
]


@pytest.mark.parametrize("page", RUN_PAGES)
def test_the_commands_of_the_page_run(page: Path, workplace: Path, monkeypatch, brax_ranks) -> None:
    runner = Runner(monkeypatch)
    for block in blocks(page):
        if block.mark.startswith("file: "):
            Path(block.mark.removeprefix("file: ")).write_text(block.body, encoding="utf-8")
        elif block.language == "sh" and not block.title:
            for line in block.commands:
                runner.sh(line)
        elif block.mark == "runs" and page.name != "your_own.md":  # test_docs.py runs those
            exec(compile(block.body, page.name, "exec"), {"__name__": "__main__"})
    written = workplace / "runs/mine"
    assert not written.exists() or read_policy(written / "policy.npz")
