import pytest

from benchmarks.quadruped.public import simulated
from jaxleas.footsteps import FootstepRecords


@pytest.fixture(scope="session")
def public(tmp_path_factory) -> FootstepRecords:
    """The public footsteps of a simulated AlienGo."""
    from tests.conftest import SHARED

    if not SHARED.is_dir():
        pytest.skip("the reference data (../shared) is not here")
    return simulated(SHARED / "data" / "quadruped")
