"""Static equilibrium against the published library, where its wheel is installed.

`pip install hpp-centroidal-dynamics`. It is asked in a process of its own: its shared libraries lie
where only LD_LIBRARY_PATH finds them, which is read when a process begins.
"""

import importlib.util
import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from jaxleas.dynamics import equilibrium_robustness
from tests.dynamics.test_equilibrium import random_stances

MASS, FRICTION = 90.27, 0.5
ASK = """
import json, sys
import numpy as np
import hpp_centroidal_dynamics as published
stances = np.load(sys.argv[1])
found = []
for points, normals, com in zip(stances["points"], stances["normals"], stances["com"]):
    equilibrium = published.Equilibrium("test", float(sys.argv[2]), 4)
    kind = published.EquilibriumAlgorithm.EQUILIBRIUM_ALGORITHM_DLP
    equilibrium.setNewContacts(points, normals, float(sys.argv[3]), kind)
    status, robustness = equilibrium.computeEquilibriumRobustness(com)
    found.append([str(status), robustness])
print(json.dumps(found))
"""


@pytest.mark.skipif(
    importlib.util.find_spec("hpp_centroidal_dynamics") is None,
    reason="the wheel hpp-centroidal-dynamics is not installed",
)
def test_agrees_with_the_published_library(tmp_path: Path) -> None:
    points, normals, com = random_stances(60, seed=11)
    np.savez(tmp_path / "stances.npz", points=points, normals=normals, com=com)
    spec = importlib.util.find_spec("hpp_centroidal_dynamics")
    assert spec is not None
    assert spec.origin is not None
    prefix = next(each for each in Path(spec.origin).parents if each.name == "cmeel.prefix")
    answer = subprocess.run(
        [sys.executable, "-c", ASK, str(tmp_path / "stances.npz"), str(MASS), str(FRICTION)],
        env={**os.environ, "LD_LIBRARY_PATH": str(prefix / "lib")},
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert answer.returncode == 0, answer.stderr
    statuses, expected = zip(*json.loads(answer.stdout.splitlines()[-1]), strict=True)
    assert all("OPTIMAL" in status for status in statuses)
    found = equilibrium_robustness(points, normals, com, mass=MASS, friction=FRICTION)
    assert (found > 0).any()
    assert (found < 0).any()
    np.testing.assert_allclose(found, expected, rtol=1e-5, atol=1e-4)
