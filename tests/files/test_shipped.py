"""What comes with the package is found by name; a user's own file of that name comes first."""

from pathlib import Path

import pytest
import yaml

from jaxleas.configuration import layers_of
from jaxleas.files import config_file, policy_path, shipped_folder
from jaxleas.files import shipped as module
from jaxleas.types import InputError

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def here(tmp_path: Path, monkeypatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_a_checkout_ships_what_stands_at_its_top() -> None:
    assert shipped_folder("configs") == ROOT / "configs"
    assert config_file("leas_p1") == ROOT / "configs/leas_p1.yaml"
    assert policy_path("pretrained:leas_p1") == ROOT / "pretrained/leas_p1.npz"


def test_a_wheel_ships_what_is_inside_the_package(here: Path, monkeypatch) -> None:
    monkeypatch.setattr(module, "_PACKAGE", here)
    (here / "shipped/configs").mkdir(parents=True)
    (here / "shipped/configs/mine.yaml").touch()
    assert config_file("mine") == here / "shipped/configs/mine.yaml"


def test_a_path_is_a_path(here: Path) -> None:
    for path in ("leas_p1.yaml", "configs/leas_p1.yaml", "./leas_p1/x", "runs/leas_p1"):
        assert config_file(path) == policy_path(path) == Path(path)
    Path("leas_p1").mkdir()  # a folder of a run, say, is no configuration
    assert config_file("leas_p1").parent == ROOT / "configs"
    Path("leas_p2_mip").touch()
    assert config_file("leas_p2_mip") == Path("leas_p2_mip")


def test_a_file_extends_what_is_shipped(here: Path) -> None:
    Path("mine.yaml").write_text("extends: leas_p1\nseed: 3\n")
    layers = layers_of("mine.yaml")
    assert layers[-1] == ("mine.yaml", {"seed": 3})
    assert layers[-2][1] == yaml.safe_load((ROOT / "configs/leas_p1.yaml").read_text())


@pytest.mark.parametrize("name", ["leas_p9", "", "../configs/leas_p1", "leas_p1.npz", "a\0b"])
def test_a_wrong_name_lists_the_right_ones(name: str) -> None:
    with pytest.raises(
        InputError, match="comes with jaxleas; give one of gaits, leas_p1, leas_p2_mip"
    ):
        policy_path(f"pretrained:{name}")


def test_a_configuration_that_is_none_lists_those_there_are() -> None:
    with pytest.raises(InputError, match="give one of gaits, leas_limits, leas_p1"):
        config_file("leas_p9")
