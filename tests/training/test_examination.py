"""What is counted in an examination: shares of all starts, of each cell, and of the worst one."""

import jax.numpy as jnp
import numpy as np
import pytest

from jaxleas.envs import Examination
from jaxleas.envs.steering import Steering, SteeringConfig, TerrainConfig
from jaxleas.envs.steering.terrain_config import LinkShares
from jaxleas.training.config import HeldOutConfig
from jaxleas.training.examination import _fractions

GROUPS = ("bridge", "stairs", "gap", "void")
REACHED = np.array([True, True, False, True, True, False, False, False])
FAILED = np.array([False, False, True, False, False, True, False, False])
GROUP = np.array([0, 0, 0, 1, 2, 2, 2, 3])


@pytest.mark.parametrize("array", [np.asarray, jnp.asarray], ids=["host", "device"])
def test_the_worst_cell_counts(array):
    examination = Examination(8, 10, ("bridge", "stairs"), ("gap", "void"), by_worst=True)
    found = _fractions(examination, GROUPS, array(REACHED), array(FAILED), array(GROUP))
    assert float(found["held_out/reached"]) == pytest.approx(3 / 4)  # the gaps do not count
    assert float(found["held_out/reached/bridge"]) == pytest.approx(2 / 3)
    assert float(found["held_out/reached/stairs"]) == 1.0
    assert float(found["held_out/valid/gap"]) == pytest.approx(2 / 3)
    assert float(found["held_out/valid/void"]) == 1.0
    assert float(found["held_out/worst"]) == pytest.approx(2 / 3)
    assert float(found["held_out/invalid"]) == pytest.approx(2 / 8)


def test_a_cell_without_starts_is_not_the_worst():
    examination = Examination(3, 10, ("bridge", "stairs"), ("void",), by_worst=True)
    found = _fractions(examination, GROUPS, REACHED[:3], FAILED[:3], GROUP[:3])
    assert np.isnan(found["held_out/reached/stairs"])
    assert float(found["held_out/worst"]) == pytest.approx(2 / 3)


def test_without_places_to_stop_all_starts_count():
    found = _fractions(Examination(8, 10), GROUPS, REACHED, FAILED, GROUP)
    assert set(found) == {"held_out/reached", "held_out/invalid", "held_out/stopped"}
    assert found["held_out/reached"] == pytest.approx(4 / 8)


def test_steering_is_examined_at_all_kinds_that_have_a_share():
    shares = LinkShares(gap=0.1, void=0.1, rubble=0.0)
    task = Steering(SteeringConfig(), TerrainConfig(shares=shares, examined="all"))
    examination = task.examination(HeldOutConfig())
    assert examination.cells == ("bridge", "stairs_up", "stairs_down")
    assert examination.stops == ("gap", "void")
    assert examination.by_worst
    plain = Steering(SteeringConfig(), TerrainConfig(shares=shares)).examination(HeldOutConfig())
    assert (plain.cells, plain.stops, plain.by_worst) == ((), (), False)
