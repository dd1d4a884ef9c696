"""The registry of planners: the one place that names them."""

import ast
import sys
from pathlib import Path

import pytest

import jaxleas
from jaxleas import cli
from jaxleas.contacts.own_planner import OwnPlanner
from jaxleas.contacts.planner import Planner
from jaxleas.contacts.planner_settings import plan_settings_from, settings_from
from jaxleas.contacts.registry import PLANNERS, find_planner, measures_of, title_of
from jaxleas.contacts.settings import PlannerSettings
from jaxleas.distillation.config import DistillationConfig
from jaxleas.sweeps.config import Exact
from jaxleas.terrain.scene_file import write_scene
from jaxleas.types import InputError
from tests.contacts.sampling.worlds import flat, straight

ROOT = Path(jaxleas.__file__).parent
OWN_MODULES = (
    *("contacts/registry.py", "contacts/programs", "contacts/search"),
    *("contacts/plan_sampling.py", "contacts/sampling_planner.py"),
)
CHOICES = {"mip", "sampling", "sl1m", "astar"}


def named_choices(source: str) -> set[str]:
    """Return the names of planners that a file holds as whole strings."""
    texts = (node for node in ast.walk(ast.parse(source)) if isinstance(node, ast.Constant))
    return CHOICES & {node.value for node in texts if isinstance(node.value, str)}


def test_a_planner_is_named_in_the_registry_and_in_its_own_modules_alone() -> None:
    found = {
        str(path.relative_to(ROOT)): names
        for path in ROOT.rglob("*.py")
        if (names := named_choices(path.read_text(encoding="utf-8")))
        and not str(path.relative_to(ROOT)).startswith(OWN_MODULES)
    }
    assert not found
    assert named_choices((ROOT / "contacts/registry.py").read_text(encoding="utf-8")) == CHOICES


@pytest.mark.parametrize("name", PLANNERS)
def test_every_planner_says_what_it_is(name: str) -> None:
    planner = find_planner(name)
    assert planner.name == name
    assert isinstance(planner, Planner)
    assert planner.title == title_of(name) != ""
    assert planner.needs in ("problem", "guide")
    assert issubclass(planner.settings, PlannerSettings)
    assert settings_from(name).keep_every == planner.settings().keep_every >= 1
    assert planner.grain.task >= 1 <= planner.grain.shard
    assert measures_of(name) == planner.measures


def test_who_reports_what() -> None:
    assert [name for name in PLANNERS if "robustness" in measures_of(name)] == ["sampling"]
    assert [name for name in PLANNERS if "combinations" in measures_of(name)] == ["sl1m"]


@pytest.mark.parametrize(
    "ask",
    [
        find_planner,
        lambda name: DistillationConfig(planner=name),
        lambda name: cli.run(["plan", "p.json", "--planner", name, "--out", "plan.json"]),
    ],
)
def test_an_unknown_name_gets_the_nearest_and_the_list(ask) -> None:
    with pytest.raises((InputError, ValueError)) as caught:
        ask("samplin")
    text = str(caught.value)
    assert "there is no planner 'samplin'; perhaps you meant sampling; there are" in text
    assert all(name in text for name in PLANNERS)


def test_a_sweep_takes_built_in_planners_alone() -> None:
    assert Exact(measure="exact", planner="mip").planner == "mip"
    for name in ("magic", "module:Class"):
        with pytest.raises(ValueError, match="there are sampling, mip, sl1m, astar"):
            Exact(measure="exact", planner=name)


def test_an_option_of_another_planner_names_its_owner() -> None:
    with pytest.raises(InputError, match="--cost is for the planner mip, not for sl1m"):
        plan_settings_from(find_planner("sl1m"), cost="linear")
    with pytest.raises(InputError, match="--model is for the planner mip, sl1m and astar, not for"):
        settings_from("sampling", model="feet")


MODULE = """
from jaxleas.contacts.plan import ContactPlan
from jaxleas.contacts.planner import Planner
from jaxleas.contacts.settings import PlannerSettings

class Shy(Planner):
    title = "Shy"
    settings = plan_settings = PlannerSettings

    def judge(self, asked, settings):
        return []

    def plan(self, asked, settings, *, time_limit, diagnose=True):
        status = f"{asked.robot} walks {len(asked.guide)}, 1 in {settings.keep_every}"
        return ContactPlan(self.name, False, "not_found", status)
"""


@pytest.fixture
def here(tmp_path, monkeypatch):
    from jaxleas.guide.files import write_guide_paths

    (tmp_path / "shy_planners.py").write_text(MODULE)
    write_guide_paths(tmp_path / "walks.npz", [straight(1.0)], ["reached"])
    write_scene(tmp_path / "flat.json", flat())
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", [*sys.path])
    yield tmp_path
    sys.modules.pop("shy_planners", None)


def test_code_is_imported_with_permission_alone(here) -> None:
    (here / "evil.py").write_text("raise SystemExit('it ran')")
    with pytest.raises(InputError, match="is code: if you trust it, give"):
        find_planner("evil:Planner")
    assert title_of("evil:Planner") == "evil:Planner"
    assert measures_of("evil:Planner") == frozenset()
    assert DistillationConfig(planner="evil:Planner").planner == "evil:Planner"
    assert "evil" not in sys.modules
    assert find_planner("shy_planners:Shy", ["shy_planners:Shy"]).title == "Shy"


def test_a_whole_planner_of_ones_own_plans_on_the_command_line(here, capsys) -> None:
    line = "contacts walks.npz --scene flat.json --planner shy_planners:Shy --every 3 --out p.json"
    cli.run(line.split())
    assert "talos walks" in capsys.readouterr().out
    with pytest.raises(
        InputError, match="chooses its own contacts: --window is for mip, sl1m and astar"
    ):
        cli.run([*line.split(), "--window", "0.7"])


def test_a_planner_that_judges_only_says_so() -> None:
    class Judges(OwnPlanner):
        pass

    from jaxleas.contacts.own_planner import JudgedByOwn

    with pytest.raises(InputError, match="judges guide paths and writes no plans"):
        JudgedByOwn("m:Judges", Judges).plan(None, Judges(), time_limit=1.0)
