"""What is declared is used, and what is used is declared and locked."""

import ast
import importlib.util
import re
import sys
import tomllib
from collections.abc import Iterator
from importlib.metadata import packages_distributions
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
IMPORTED_BY_OTHERS = {"flatbuffers": "jax._src.export.serialization"}
"""What a library imports without asking for it."""
COME_WITH_OTHERS = {
    **{"markupsafe": "jinja2", "protobuf": "onnx"},
    **dict.fromkeys(("mujoco-core", "mujoco-mjx", "mujoco-studio"), "mujoco"),
}
"""Types of a library's own interface that it has from another."""


def normal(name: str) -> str:
    return re.sub(r"[-_.]+", "-", name).lower()


def names_of(requirements: list[str]) -> set[str]:
    return {normal(re.split(r"[\[<>=!~; ]", each, maxsplit=1)[0]) for each in requirements}


DECLARED = names_of(PROJECT["dependencies"])
OPTIONAL = {
    name for each in PROJECT["optional-dependencies"].values() for name in names_of(each)
} - {"jaxleas"}


def imported_by(source: str) -> Iterator[str]:
    """Yield the packages that a file imports, also inside its functions and by name."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            yield from (alias.name.partition(".")[0] for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.level == 0:
            yield (node.module or "").partition(".")[0]


def distributions_used() -> set[str]:
    files = [*(ROOT / "jaxleas").rglob("*.py"), ROOT / "train.py"]
    modules = {name for file in files for name in imported_by(file.read_text(encoding="utf-8"))}
    owners = packages_distributions()
    foreign = modules - sys.stdlib_module_names - {"jaxleas", "__future__"}
    used: set[str] = set()
    for name in foreign:
        found = {normal(owner) for owner in owners.get(name, [])}
        # Several packages may install into one module, such as MuJoCo's: the declared one counts.
        used |= found & (DECLARED | OPTIONAL) or found
    return used


def test_every_dependency_is_imported() -> None:
    assert sorted(DECLARED - distributions_used() - IMPORTED_BY_OTHERS.keys()) == []


def test_every_import_is_declared() -> None:
    used = distributions_used() - COME_WITH_OTHERS.keys()
    assert sorted(used - DECLARED - OPTIONAL) == []
    assert set(COME_WITH_OTHERS.values()) <= DECLARED | OPTIONAL


@pytest.mark.parametrize(("module", "importer"), IMPORTED_BY_OTHERS.items())
def test_what_is_declared_for_another_library_is_imported_there(module: str, importer: str) -> None:
    found = importlib.util.find_spec(importer)
    assert found is not None
    assert found.origin is not None
    assert module in set(imported_by(Path(found.origin).read_text(encoding="utf-8")))


@pytest.mark.parametrize("name", ["run", "dev"])
def test_every_dependency_is_locked(name: str) -> None:
    lines = (ROOT / "requirements" / f"{name}.txt").read_text(encoding="utf-8").splitlines()
    assert sorted(DECLARED - names_of(lines)) == []
