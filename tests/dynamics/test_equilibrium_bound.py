import numpy as np
import pytest

from jaxleas.dynamics import ContactPoints, equilibrium_robustness
from jaxleas.dynamics.equilibrium_bound import decide_robustness
from tests.dynamics.test_equilibrium import FEET, UP, random_stances


@pytest.mark.parametrize("least", [-3.0, 0.0, 2.0, 15.0])
@pytest.mark.parametrize("level", [True, False])
def test_never_contradicts_the_linear_program_and_often_decides(least, level):
    points, normals, com = random_stances(200, seed=11)
    if level:
        points, normals = np.tile(FEET, (200, 1, 1)), np.tile(UP, (200, 1, 1))
    exact = equilibrium_robustness(points, normals, com, mass=90.0, friction=0.5)
    contacts = ContactPoints(points, normals, 0.5)
    there, missing = decide_robustness(contacts, com, mass=90.0, least=least)
    assert not (there & (exact < least - 1e-9)).any()
    assert not (missing & (exact >= least + 1e-9)).any()
    if level and least >= 0.0:
        assert (there | missing).mean() > 0.3
        assert there.any()
        assert missing.any()
