"""Products in bfloat16 where there are units for them, and nowhere else."""

from types import SimpleNamespace

import pytest

from jaxleas.training.config import NetworkConfig
from jaxleas.xla.matrix_units import has_matrix_units, multiplies_bfloat16


@pytest.mark.parametrize(
    ("lines", "expected"),
    [
        ("model name\t: Xeon\nflags\t\t: fpu amx_bf16 amx_tile\n", True),
        ("flags\t\t: fpu avx512_bf16 amx_tile\n", False),
        ("model name\t: amx_bf16\n", False),
        ("", False),
    ],
)
def test_a_processor_is_known_by_its_features(tmp_path, lines, expected):
    path = tmp_path / "cpuinfo"
    path.write_text(lines)
    assert has_matrix_units(path) is expected


def test_without_a_list_of_features_there_are_none(tmp_path):
    assert not has_matrix_units(tmp_path / "nowhere")


@pytest.mark.parametrize(("capability", "expected"), [("7.5", False), ("8.0", True), ("9.0", True)])
def test_a_gpu_is_known_by_its_capability(capability, expected):
    assert multiplies_bfloat16(SimpleNamespace(compute_capability=capability)) is expected


def test_other_accelerators_have_them():
    assert multiplies_bfloat16(SimpleNamespace())


def test_auto_asks_the_machine_and_a_choice_does_not(monkeypatch):
    monkeypatch.setattr("jaxleas.xla.native_products", lambda: "bfloat16")
    assert NetworkConfig(products="auto").product_type == "bfloat16"
    assert NetworkConfig(products="float32").product_type == "float32"
