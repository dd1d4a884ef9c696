import pytest

from jaxleas.evaluation.comparison import Planning, compare
from jaxleas.evaluation.contenders import make_contenders, parse_policies
from jaxleas.evaluation.examination import load_candidate
from jaxleas.evaluation.forecast import Forecast
from jaxleas.evaluation.result_file import read_evaluation
from jaxleas.labels import Judge, MipSettings
from jaxleas.reports.commands import evaluate
from jaxleas.reports.published import published
from jaxleas.reports.side_by_side import markdown, rows
from jaxleas.training.policy import write_policy
from jaxleas.types import InputError
from tests.evaluation.conftest import random_policy
from tests.evaluation.test_exact import verdict
from tests.reports.test_table import cell, evaluation

BASELINES = ("rb_lin", "rb_kino")


@pytest.fixture
def asked(monkeypatch):
    """Planners that say yes at once; returns what they were asked."""
    calls = []

    def judge(self, scenes, paths, scene_index, on_done=lambda count: None):
        calls.append((self.planner, len(paths)))
        on_done(len(paths))
        return [verdict(number, True) for number in range(len(paths))]

    monkeypatch.setattr(Judge, "judge", judge)
    return calls


def essence(result):
    return result.model_dump(exclude={"seconds", "created"})


def test_an_interrupted_comparison_goes_on_where_it_was(run, flat_suite, tmp_path, asked):
    candidate = load_candidate(run)
    contenders = make_contenders(candidate, wanted=BASELINES)
    file, spoken = tmp_path / "table.json", []

    def stop_at_the_fourth(text):
        spoken.append(text)
        if " 4/8: " in text:
            raise KeyboardInterrupt

    arguments = (candidate, contenders, flat_suite, Planning(("sampling", "mip")))
    with pytest.raises(KeyboardInterrupt):
        compare(*arguments, file=file, say=stop_at_the_fourth)
    assert len(read_evaluation(file).cells) == 3
    asked.clear()
    resumed = compare(*arguments, file=file)
    assert len(asked) == 5
    assert essence(resumed) == essence(read_evaluation(file)) == essence(compare(*arguments))
    assert "left" in spoken[-1]
    assert [each.yaw for each in resumed.cells] == [0.0] * 4 + [180.0] * 4


def test_what_has_changed_is_judged_again_and_nothing_else(run, flat_suite, tmp_path, asked):
    file, candidate = tmp_path / "table.json", load_candidate(run)
    further = write_policy(tmp_path / "p2.npz", random_policy(seed=2)) or tmp_path / "p2.npz"

    def again():
        asked.clear()
        policies = {"leas_p2_mip": further}
        names = ("rb_lin", "leas_p2_mip")
        contenders = make_contenders(load_candidate(run), policies, names)
        compare(load_candidate(run), contenders, flat_suite, Planning(("mip",)), file=file)
        return read_evaluation(file)

    before = again()
    assert {each.method for each in before.cells} == {"rb_lin", "leas_p2_mip"}
    assert set(before.policies) == {"leas_p2_mip"}
    assert before.planners["mip"]["keep_every"] == 14
    again()
    assert asked == []
    compare(
        candidate,
        make_contenders(candidate, wanted=("rb_lin",)),
        flat_suite,
        Planning(("mip",), {"mip": MipSettings(keep_every=10)}),
        file=file,
    )
    assert len(asked) == 2
    assert {each.method for each in read_evaluation(file).cells} == {"rb_lin"}
    write_policy(run / "policy.npz", random_policy(seed=3))  # another candidate: all anew
    assert len(again().cells) == 4


OWN_METHOD = """
class Still:
    def __init__(self, limits, desired_speed):
        pass

    def __call__(self, heights_in_root, motion, goal):
        return motion
"""


def test_a_method_of_ones_own_stands_side_by_side(run, flat_suite, tmp_path, asked, monkeypatch):
    monkeypatch.syspath_prepend(str(tmp_path))
    (tmp_path / "own_contender.py").write_text(OWN_METHOD)
    candidate, names = load_candidate(run), ["own_contender:Still", "rb_lin"]
    contenders = make_contenders(candidate, wanted=names)
    assert list(contenders.methods) == ["rb_lin", "own_contender:Still"]
    found = compare(candidate, contenders, flat_suite, Planning(("mip",)))
    own = [each for each in found.cells if each.method == "own_contender:Still"]
    assert [each.reached for each in own] == [0.0, 0.0]
    assert [each.stopped for each in own] == [1.0, 1.0]
    assert set(found.policies) == {"own_contender:Still"}  # its code: what changed walks again
    assert "own_contender:Still" in markdown(found)


def test_methods_are_chosen_by_name(run, tmp_path):
    candidate = load_candidate(run)
    assert list(make_contenders(candidate).methods) == [
        "rb_lin",
        "rb_kino",
        "rb_kino_rrt",
        "leas_p1",
    ]
    with pytest.raises(InputError, match="did you mean 'rb_kino'"):
        make_contenders(candidate, wanted=["rb_kin"])
    with pytest.raises(InputError, match="there already"):
        make_contenders(candidate, {"leas_p1": run})
    assert list(make_contenders(candidate, wanted=["leas", "lin"]).methods) == ["rb_lin", "leas_p1"]
    assert parse_policies(["a=x/y", "b=z=1"])["b"].name == "z=1"
    for wrong in ("leas_p2", "=path", "leas p2=path", "a="):
        with pytest.raises(InputError, match="name=path"):
            parse_policies([wrong])
    with pytest.raises(InputError, match="two policies"):
        parse_policies(["a=x", "a=y"])


def test_the_command_writes_and_prints_the_table(run, tmp_path, capsys, asked):
    further = tmp_path / "p2.npz"
    write_policy(further, random_policy(seed=2))
    result = evaluate(
        run,
        suite="hole",
        starts=2,
        held_out=True,
        planners=["sampling,mip"],
        methods=["rb_lin", "leas_p2_mip"],
        policies=[f"leas_p2_mip={further}"],
        processes=1,
    )
    assert result.suite == "hole_held_out"
    assert len(result.cells) == 4
    kept = run / "evaluation" / "side_by_side_hole_held_out_2_seed0.json"
    assert read_evaluation(kept) == result
    printed = capsys.readouterr().out
    assert "LEAS-P2 (MIP)" in printed
    assert str(kept) in printed
    with pytest.raises(InputError, match="no planner 'mipp'"):
        evaluate(run, suite="hole", planners=["mipp"])
    with pytest.raises(InputError, match="processes is 0"):
        evaluate(run, suite="hole", planners=["mip"], processes=0)
    with pytest.raises(InputError, match="time"):
        evaluate(run, suite="hole", planners=["mip"], starts=2, time_limit=-1.0)
    with pytest.raises(InputError, match="--max-combinations -1"):
        evaluate(run, suite="hole", planners=["sl1m"], starts=2, max_combinations=-1)
    for name, content in (("empty.json", ""), ("scene.json", '{"surfaces": {}}')):
        (run / name).write_text(content)
        with pytest.raises(InputError, match="is there and holds no evaluation"):
            evaluate(run, suite="hole", starts=2, json=run / name)
        assert (run / name).read_text() == content
    with pytest.raises(InputError, match="is a file; give a folder"):
        evaluate(run, suite="hole", starts=2, pictures=run / "empty.json")


def test_pictures_show_every_method(run, tmp_path, flat_suite, monkeypatch):
    from jaxleas.reports.scene_pictures import draw_side_by_side

    candidate = load_candidate(run)
    methods = make_contenders(candidate, wanted=["rb_lin"]).methods
    files = draw_side_by_side(candidate.env, methods, flat_suite, (), tmp_path / "pictures")
    assert [file.name for file in files] == ["flat_0deg_0cms.png", "flat_180deg_0cms.png"]
    assert all(file.read_bytes().startswith(b"\x89PNG") for file in files)


def test_a_row_holds_every_planner_and_the_thesis_beside_its_own():
    common = {"name": "stairs_up", "yaw": 0.0, "speed": 0.04, "high": 0.99}
    sampling = cell(**common, planner="sampling", planned=0.98, robustness=28.04, mean_step=0.2)
    mip = cell(**common, planner="mip", planned=0.975, mean_step=0.26)
    kino = cell(**common, method="rb_kino_rrt", planner="sampling", planned=0.98)
    (one, other) = rows(evaluation("thesis", sampling, mip, kino))
    assert one == (
        *("stairs up", "0°", "0.04", "LEAS-P1", "99.0 %", "98.5 %"),
        *("98.0 %", "98-99", "28.0", "20.0 cm"),
        *("97.5 %", "98-99", "26.0 cm", "100 %"),
    )
    assert other[-4:] == ("-", "-", "-", "74 %")
    assert published(cell(**common, method="rb_lin", planner="sampling", planned=0.98)) is None
    lines = markdown(evaluation("thesis", sampling, mip, kino)).splitlines()
    assert len({line.count("|") for line in lines}) == 1


def test_the_forecast_is_of_each_planners_own_pace(flat_suite):
    clock, said = [0.0], []
    forecast = Forecast(flat_suite, 1, ("sampling", "mip"), said.append, lambda: clock[0])
    one, two = flat_suite.cells
    forecast.guides(one, "rb_lin", "sampling", 0)
    assert "left" not in said[-1]
    clock[0] = 10.0
    forecast.result(one, "sampling")
    assert forecast.left() == "0:30"  # MIP is not known yet
    clock[0] = 110.0
    forecast.result(one, "mip")
    assert forecast.left() == "1:50"
    forecast.guides(two, "rb_lin", "mip", 3)
    assert said[-1] == "flat 3/4: RB-Lin on flat at 180 deg: mip, 3 guide paths; 1:50 left"
    forecast.skip(two, "mip")
    assert forecast.left() == "0:10"
