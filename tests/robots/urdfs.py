"""Where the published URDFs are, for tests that compare with Pinocchio."""

import site
from pathlib import Path

import pytest

SHARE = "cmeel.prefix/share/example-robot-data/robots"


def published(name: str) -> Path:
    """Return the path of a URDF of `example-robot-data`; the test skips where there is none."""
    for folder in site.getsitepackages():
        if (path := Path(folder) / SHARE / name).is_file():
            return path
    pytest.skip(f"{name} of example-robot-data is not installed")


TALOS = "talos_data/robots/talos_reduced.urdf"
G1 = "g1_description/urdf/g1_29dof_rev_1_0.urdf"
ANYMAL_B = "anymal_b_simple_description/robots/anymal.urdf"
PANDA = "panda_description/urdf/panda.urdf"
