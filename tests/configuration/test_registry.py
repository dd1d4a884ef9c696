"""Plugs are named in one place, and code that a file alone names is never run."""

import sys
from pathlib import Path

import pytest

from jaxleas.configuration.registry import Registry
from jaxleas.types.errors import InputError


def _require(name: str, item: object) -> None:
    if not isinstance(item, type):
        raise InputError(f"{name} is no class")


SHAPES: Registry[type] = Registry(
    "shape", {"box": "jaxleas.geometry:Box", "polytope": "jaxleas.geometry:Polytope"}, _require
)


def test_a_built_in_item_is_found_by_its_name() -> None:
    assert SHAPES.find("box").__name__ == "Box"
    assert list(SHAPES) == ["box", "polytope"]
    assert "box" in SHAPES
    assert "ball" not in SHAPES


def test_an_unknown_name_gets_the_nearest_and_the_list() -> None:
    with pytest.raises(InputError, match=r"no shape 'bax'; perhaps you meant box; there are box, "):
        SHAPES.find("bax")


def test_own_code_is_imported_only_where_it_is_allowed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "my_shapes.py").write_text("class Ball: pass\nball = 3\n")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", list(sys.path))
    with pytest.raises(InputError, match=r"my_shapes:Ball is code.*--allow my_shapes:Ball"):
        SHAPES.find("my_shapes:Ball")
    assert "my_shapes" not in sys.modules
    assert SHAPES.find("my_shapes:Ball", ["my_shapes:Ball"]).__name__ == "Ball"
    with pytest.raises(InputError, match="my_shapes:ball is no class"):
        SHAPES.find("my_shapes:ball", ["my_shapes:ball"])
    with pytest.raises(InputError, match="shape my_shapes:Bowl cannot be loaded"):
        SHAPES.find("my_shapes:Bowl", ["my_shapes:Bowl"])
    sys.modules.pop("my_shapes")
