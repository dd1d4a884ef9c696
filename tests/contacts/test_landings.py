"""What touches, as pictures and the viewer show it: on floors, slopes and walls."""

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.figure import Figure

from jaxleas.contacts.landings import landings_of
from jaxleas.contacts.pictures import VIEWS, _draw_contacts, draw_plan
from jaxleas.contacts.plan import ContactPlan
from jaxleas.contacts.problem import ContactProblem, FootPose, Step
from jaxleas.contacts.surfaces import make_surface
from jaxleas.robots import write_robot
from tests.contacts.effectors import FLOOR, WALL, leaner
from tests.contacts.worlds import problem, stones

SOLE = (0.05, 0.04)
RAMP = np.array([[1.0, -1.0, 0.0], [3.0, -1.0, 1.0], [3.0, 1.0, 1.0], [1.0, 1.0, 0.0]])
"""It rises by one in two along x [m]."""


@pytest.fixture
def leaning(tmp_path, monkeypatch) -> tuple[ContactProblem, ContactPlan]:
    """A robot puts a foot on a ramp, and its palm on a wall across x."""
    monkeypatch.chdir(tmp_path)
    write_robot("robots/leaner.json", leaner())
    feet = {name: FootPose(np.array([0.0, y, 0.0]), 0.0) for name, y in (("LF", 0.1), ("RF", -0.1))}
    initial = feet | {"RH": FootPose(np.array([0.5, -0.2, 0.9]), 0.0)}
    surfaces = {"floor": FLOOR, "wall": WALL, "ramp": RAMP}
    asked = replace(
        problem(stones(0.05)),
        robot="leaner",
        model="feet",
        surfaces={name: make_surface(each, name) for name, each in surfaces.items()},
        initial=initial,
        steps=(Step("LF", 0.0, ("ramp",)), Step("RH", 0.0, ("wall",))),
        half_sizes=dict.fromkeys(initial, SOLE),
    )
    places = np.array([[2.0, 0.1, 0.5], [0.5, -0.3, 1.1]])
    return asked, ContactPlan("mip", True, "feasible", surfaces=("ramp", "wall"), footholds=places)


def test_what_touches_lies_on_its_surface(leaning) -> None:
    asked, plan = leaning
    landings = landings_of(asked, plan)
    assert [(each.effector, each.step) for each in landings] == [
        *(("LF", 0), ("RF", 0), ("RH", 0)),
        *(("LF", 1), ("RH", 2)),
    ]
    surfaces = ("floor", "floor", "wall", "ramp", "wall")
    for landing, name in zip(landings, surfaces, strict=True):
        surface = asked.surfaces[name]
        np.testing.assert_allclose(landing.corners @ surface.normal, surface.offset, atol=1e-9)
        edges = np.linalg.norm(np.diff(landing.corners, axis=0), axis=1)
        np.testing.assert_allclose(sorted(edges)[-1], 2.0 * max(landing.half_size))


def test_each_view_shows_its_projection(leaning) -> None:
    asked, plan = leaning
    seen = {}
    for view, shown in VIEWS.items():
        ax = Figure().subplots()
        _draw_contacts(ax, asked, plan, shown)
        seen[view] = [np.ptp(patch.get_xy(), axis=0) for patch in ax.patches]
    slant = 1.0 / np.hypot(1.0, 0.5)
    np.testing.assert_allclose(seen["above"][3], [0.1 * slant, 0.08], atol=1e-9)  # foot, ramp
    np.testing.assert_allclose(seen["from the side"][3], [0.1 * slant, 0.05 * slant], atol=1e-9)
    assert seen["above"][4][0] == pytest.approx(0.0, abs=1e-9)  # palm, edge on
    assert seen["from the side"][4][0] == pytest.approx(0.0, abs=1e-9)
    assert seen["from the side"][4][1] > 0.05


def test_a_point_foot_is_a_dot(leaning, tmp_path) -> None:
    asked, plan = leaning
    pointed = replace(asked, half_sizes=asked.half_sizes | {"LF": (0.0, 0.0)})
    ax = Figure().subplots()
    _draw_contacts(ax, pointed, plan, (0, 1))
    dots = [line for line in ax.lines if line.get_marker() == "."]
    assert [line.get_xydata().tolist() for line in dots] == [[[0.0, 0.1]], [[2.0, 0.1]]]
    assert len(ax.patches) == 3
    draw_plan(tmp_path / "plan.png", pointed, plan)
    assert (tmp_path / "plan.png").stat().st_size > 5000
