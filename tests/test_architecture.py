"""The order of the rooms, as docs and house rules state it: each imports only from those above."""

import ast
import functools
import graphlib
import importlib
import importlib.util
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

import jaxleas

ROOT = Path(jaxleas.__file__).parent
ORDER = (
    *("types", "xla", "files", "configuration", "workers", "runs", "geometry", "robots", "terrain"),
    *(
        "modelling",
        "dynamics",
        "conditions",
        "contacts",
        "physics",
        "controllers",
        "envs",
        "training",
        "guide",
    ),
    *(
        "labels",
        "surrogates",
        "multicontact",
        "footsteps",
        "gaits",
        "crossing",
        "evaluation",
        "reports",
    ),
    *("distillation", "sweeps", "records", "export", "viewer"),
    *("cli_guard", "cli_options", "train_command", "cli", "__main__"),
)
"""Of physics, controllers and multicontact there is the place alone."""
# What keeps the loop of data open: these may not, although the order would let them.
FORBIDDEN = {"surrogates": {"labels"}}
MOST_PARAMETERS = 6  # a command has one for each of its options
COMMAND_FILES = ("commands", "command")
# These serve every task.
GENERAL = (
    *("types", "xla", "files", "configuration", "workers", "runs", "geometry", "robots", "terrain"),
    *("conditions", "contacts", "labels", "training", "sweeps", "export"),
)
FILES = sorted(path for path in ROOT.rglob("*.py") if path != ROOT / "__init__.py")


def room_of(path: Path) -> str:
    return path.relative_to(ROOT).parts[0].removesuffix(".py")


@functools.cache
def imports_of(source: str) -> tuple[ast.Import | ast.ImportFrom, ...]:
    """Return the imports of a file, at its top or inside a function; parsed once."""
    return tuple(
        node
        for node in ast.walk(ast.parse(source))
        if isinstance(node, ast.Import | ast.ImportFrom)
    )


def imported_rooms(source: str, package: list[str]) -> Iterator[str]:
    """Yield the rooms that a file imports, at its top or inside a function, however spelt."""
    for node in imports_of(source):
        names: list[str] = []
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        else:
            base = package[: len(package) - node.level + 1] if node.level else []
            module = ".".join([*base, *([node.module] if node.module else [])])
            names = [f"{module}.{alias.name}" for alias in node.names]
        for name in names:
            parts = name.split(".")
            if parts[0] == "jaxleas" and len(parts) > 1:
                yield parts[1]


# Rooms within a room, each with a face of its own.
INNER_ROOMS = ("jaxleas.envs.steering", "jaxleas.envs.gait_planning")


def past_the_face(source: str, package: list[str]) -> list[str]:
    """Return what a file imports from inside another room instead of from its face."""
    found = []
    own = next((room for room in INNER_ROOMS if ".".join(package).startswith(room)), None)
    for module in imported_modules(source, package):
        parts = module.split(".")
        room = ".".join(parts[:3]) if ".".join(parts[:3]) in INNER_ROOMS else ".".join(parts[:2])
        at_home = room == own or (own is None and parts[1:2] == package[1:2])
        is_inside = parts[0] == "jaxleas" and module != room
        if is_inside and not at_home:
            found.append(module)
    return found


def imported_modules(source: str, package: list[str]) -> Iterator[str]:
    """Yield the modules that a file imports or imports names from, however spelt."""
    for node in imports_of(source):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        else:
            base = package[: len(package) - node.level + 1] if node.level else []
            yield ".".join([*base, *([node.module] if node.module else [])])


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(ROOT)))
def test_other_rooms_are_imported_by_their_face(path: Path) -> None:
    package = ["jaxleas", *path.relative_to(ROOT).parts[:-1]]
    assert past_the_face(path.read_text(encoding="utf-8"), package) == []


@pytest.mark.parametrize(
    ("source", "package", "found"),
    [
        ("from jaxleas.terrain import Scene", "jaxleas.guide", []),
        ("from jaxleas.terrain.scene import Scene", "jaxleas.terrain.scenarios", []),
        ("from jaxleas.terrain.scene import Scene", "jaxleas.guide", ["jaxleas.terrain.scene"]),
        ("def f():\n import jaxleas.terrain.scene", "jaxleas.guide", ["jaxleas.terrain.scene"]),
        ("from ..terrain.scene import Scene", "jaxleas.guide", ["jaxleas.terrain.scene"]),
        ("from jaxleas.envs.steering import Steering", "jaxleas.guide", []),
        ("from jaxleas.envs.steering.env import x", "jaxleas.guide", ["jaxleas.envs.steering.env"]),
        ("from jaxleas.envs.steering.env import x", "jaxleas.envs.steering", []),
        ("from jaxleas.envs.starts import x", "jaxleas.envs.steering", ["jaxleas.envs.starts"]),
    ],
)
def test_an_import_past_the_face_is_found(source: str, package: str, found: list[str]) -> None:
    assert past_the_face(source, package.split(".")) == found


@functools.cache
def face_of(module: str) -> dict[str, str]:
    """Return the names of a room's face, each with the module that defines it."""
    stub = ROOT.parent / Path(*module.split(".")) / "__init__.pyi"
    tree = ast.parse(stub.read_text(encoding="utf-8")) if stub.exists() else ast.Module([], [])
    return {
        alias.name: f"{module}.{node.module}"
        for node in ast.walk(tree)
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    }


@pytest.mark.parametrize(
    "room",
    [
        *sorted({room_of(path) for path in FILES if path.parent != ROOT}),
        "envs.steering",
        "envs.gait_planning",
    ],
)
def test_what_a_face_names_exists_and_hides_no_file(room: str) -> None:
    module = importlib.import_module(f"jaxleas.{room}")
    for name, defined in face_of(module.__name__).items():
        assert getattr(module, name) is getattr(importlib.import_module(defined), name)
        file = f"{module.__name__}.{name}"
        assert defined == file or importlib.util.find_spec(file) is None, f"{file} is a file, too"


def violations(room: str, source: str, package: list[str]) -> list[str]:
    allowed = {*ORDER[: ORDER.index(room) + 1]} - FORBIDDEN.get(room, set())
    return sorted(set(imported_rooms(source, package)) - allowed - {"__version__"})


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(ROOT)))
def test_a_room_imports_only_from_rooms_above_it(path: Path) -> None:
    assert room_of(path) in ORDER, f"{path} is in no room of the house"
    package = ["jaxleas", *path.relative_to(ROOT).parts[:-1]]
    assert not violations(room_of(path), path.read_text(encoding="utf-8"), package)


def long_signatures(path: Path) -> list[str]:
    """Return the functions of a file that take too many parameters, commands left out."""
    found = []
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            given = [*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs]
            count = len([each for each in given if each.arg not in ("self", "cls")])
            is_command = path.stem.rpartition("_")[2] in COMMAND_FILES and node.name[0] != "_"
            if count > MOST_PARAMETERS and not is_command:
                found.append(f"{node.name} takes {count}")
    return found


def test_many_parameters_are_values_with_names() -> None:
    assert {str(path): long_signatures(path) for path in FILES if long_signatures(path)} == {}


@pytest.mark.parametrize("room", GENERAL)
def test_a_general_room_does_not_name_steering(room: str) -> None:
    """They serve every task: what is one task's is in its own room, and the registry names it."""
    named = [
        f"{path.relative_to(ROOT)}: {line.strip()}"
        for path in FILES
        if room_of(path) == room
        for line in path.read_text(encoding="utf-8").splitlines()
        if re.search(r"steering(?! methods?\b)", line, re.IGNORECASE)
    ]
    assert not named


def test_no_files_import_each_other_in_a_circle() -> None:
    """Looked at are imports that run when a file is imported."""
    modules = {module_of(path): path for path in FILES}
    graph = {
        module: {each for each in imported_at_once(path) if each in modules and each != module}
        for module, path in modules.items()
    }
    graphlib.TopologicalSorter(graph).prepare()  # raises where there is a circle


def module_of(path: Path) -> str:
    parts = ["jaxleas", *path.relative_to(ROOT).with_suffix("").parts]
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def imported_at_once(path: Path) -> Iterator[str]:
    """Yield the modules that a file imports outside functions and outside TYPE_CHECKING."""
    waiting: list[ast.stmt] = list(ast.parse(path.read_text(encoding="utf-8")).body)
    while waiting:
        node = waiting.pop()
        if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.dump(node.test):
            continue
        if isinstance(node, ast.If | ast.Try):
            waiting += node.body
        elif isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            yield node.module
            face = face_of(node.module)
            names = [alias.name for alias in node.names]
            yield from (face.get(name, f"{node.module}.{name}") for name in names)


@pytest.mark.parametrize(
    ("room", "source", "found"),
    [
        ("envs", "def f():\n    from jaxleas.surrogates import x", ["surrogates"]),
        ("envs", "import jaxleas.training.loop", ["training"]),
        ("envs", "from jaxleas import training", ["training"]),
        ("envs", "from .. import training", ["training"]),
        ("envs", "from ..training.loop import train", ["training"]),
        ("envs", "from . import steering; from jaxleas.types import Query", []),
        ("contacts", "from jaxleas.guide import x; from jaxleas.types import y", ["guide"]),
        ("contacts", "from jaxleas.envs.registry import TASKS", ["envs"]),
        ("envs", "from jaxleas.contacts import x; from jaxleas.dynamics import y", []),
        ("surrogates", "from jaxleas import labels, conditions", ["labels"]),
        ("export", "from jaxleas.cli import main", ["cli"]),
    ],
)
def test_a_wrong_import_is_found(room: str, source: str, found: list[str]) -> None:
    assert violations(room, source, ["jaxleas", room]) == found


@pytest.mark.parametrize(
    "module", ["jaxleas.envs.steering", "jaxleas.training", "jaxleas.training.loop"]
)
def test_steering_imports_no_physics(module: str) -> None:
    if (
        not (ROOT.parent / (module.replace(".", "/") + ".py")).exists()
        and not (ROOT.parent / module.replace(".", "/") / "__init__.py").exists()
    ):
        pytest.skip(f"{module} does not exist yet")
    code = f"import sys, {module}; assert not {{'mujoco', 'brax.envs'}} & sys.modules.keys()"
    subprocess.run([sys.executable, "-c", code], check=True)


def test_no_library_imports_a_command():
    """Commands import libraries; the command line, in turn, names commands as text."""
    found = [
        f"{path.relative_to(ROOT)} imports {module}"
        for path in FILES
        if path.stem.rpartition("_")[2] not in COMMAND_FILES
        for node in imports_of(path.read_text(encoding="utf-8"))
        if isinstance(node, ast.ImportFrom) and (module := node.module or "")
        if module.rpartition(".")[2].rpartition("_")[2] in COMMAND_FILES
    ]
    assert found == []
