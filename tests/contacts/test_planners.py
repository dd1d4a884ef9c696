"""Laws and examples of the mixed-integer planner and of SL1M."""

import itertools
import time

import numpy as np
import pytest
from scipy.optimize import linprog

from jaxleas.contacts.certificate import certify
from jaxleas.contacts.programs.explanation import explain, find_blame
from jaxleas.contacts.programs.mip import plan_mip
from jaxleas.contacts.programs.prefix import last_feasible_step
from jaxleas.contacts.programs.sl1m import plan_sl1m
from jaxleas.types.errors import InputError
from tests.contacts.worlds import (
    boxes,
    content,
    moved,
    problem,
    random_world,
    rectangle,
    stones,
)

PROGRAMS = {"mip": plan_mip, "sl1m": plan_sl1m}

MODELS = ["two_com", "feet"]


def twin(described: dict) -> bool:
    """Decide by brute force: every choice of surfaces, one plain linear program each.

    Works for the yaws (all 0), rectangles and boxes of `worlds`; shares no code with the planners.
    """
    phases, surfaces = described["phases"], described["surfaces"]
    for names in itertools.product(*(phase["candidates"] for phase in phases)):
        count = len(phases)
        A, b, equal, level = [], [], [], []
        stood = {foot: np.array(p["position"]) for foot, p in described["initial"].items()}
        last: dict[str, int | None] = {"LF": None, "RF": None}
        width = 9 * count  # p, c0, c1 of each phase

        def add(terms, bound, A=A, b=b, width=width):
            row = np.zeros(width)
            for column, value in terms:
                row[column] += value
            A.append(row)
            b.append(bound)

        def relate(column, foot, rows, bounds, last=last, stood=stood, add=add):
            """A (x - p_foot) <= b, where p_foot may be a variable or the initial place."""
            for row, bound in zip(rows, bounds, strict=True):
                terms = [(column + i, row[i]) for i in range(3)]
                if last[foot] is None:
                    bound = bound + np.dot(row, stood[foot])
                else:
                    terms += [(9 * last[foot] + i, -row[i]) for i in range(3)]
                add(terms, bound)

        for k, (phase, name) in enumerate(zip(phases, names, strict=True)):
            foot, other = phase["foot"], "RF" if phase["foot"] == "LF" else "LF"
            corners = np.array(surfaces[name])
            for axis in (0, 1):
                add([(9 * k + axis, 1.0)], corners[:, axis].max())
                add([(9 * k + axis, -1.0)], -corners[:, axis].min())
            equal.append(np.eye(width)[9 * k + 2])
            level.append(corners[0, 2])
            sets = described["polytopes"]
            if described["model"] == "feet":
                reach = sets[f"{other}_in_{foot}"]
                relate(9 * k, other, -np.array(reach["A"], float), reach["b"])
            else:
                reach = sets[f"{foot}_in_{other}"]
                relate(9 * k, other, np.array(reach["A"], float), reach["b"])
                sole = np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0]], float)
                sizes = described["foot_half_size"]
                for number, over in ((0, other), (1, foot)):
                    column = 9 * k + 3 + 3 * number
                    for each in (other, foot):
                        com = sets[f"COM_in_{each}"]
                        before, last[foot] = last[foot], k if each == foot else last[foot]
                        relate(column, each, np.array(com["A"], float), com["b"])
                        if each == over:
                            size = sizes[each] if isinstance(sizes, dict) else sizes
                            relate(column, each, sole, np.repeat(size, 2))
                        last[foot] = before
            last[foot] = k
        answer = linprog(
            np.zeros(width), np.array(A), b, np.array(equal), level, bounds=(None, None)
        )
        if answer.status == 0:
            return True
    return False


@pytest.mark.parametrize("model", MODELS)
def test_the_verdict_is_that_of_brute_force(model: str) -> None:
    verdicts = []
    for seed in range(14):
        described = random_world(seed, model)
        expected = twin(described)
        for formulation, start in itertools.product(("big_m", "hull"), (False, True)):
            options = {"formulation": formulation, "start": start}
            plan = plan_mip(problem(described), diagnose=False, **options)
            assert plan.feasible == expected, (seed, options)
        assert plan_sl1m(problem(described), diagnose=False).feasible <= expected
        verdicts.append(expected)
    assert 3 <= sum(verdicts) <= 11, "worlds must be of both kinds"


def test_the_last_phase_is_that_of_brute_force() -> None:
    """The longest prefix with a plan, by enumeration; SL1M never goes beyond it."""
    found = set()
    for seed in range(14):
        described = random_world(seed, "feet")
        plan = plan_mip(problem(described))
        prefixes = [{**described, "phases": described["phases"][:n]} for n in range(1, 5)]
        expected = max((n for n, each in enumerate(prefixes) if twin(each)), default=-1)
        assert plan.last_feasible_step == expected, seed
        last = plan_sl1m(problem(described)).last_feasible_step
        assert last is not None
        assert last <= expected
        found.add(expected)
    assert len(found) >= 2, "worlds must fail in different phases"


def test_the_centre_of_mass_decides_some() -> None:
    """Otherwise the test above would not see it."""
    differ = 0
    for seed in range(14):
        described = random_world(seed, "two_com")
        without = {**described, "polytopes": {**described["polytopes"]}}
        for name in ("COM_in_LF", "COM_in_RF"):
            without["polytopes"][name] = {**boxes()[name], "b": [3, 3, 3, 3, 3, 3]}
        one, two = (plan_mip(problem(each), diagnose=False) for each in (described, without))
        differ += one.feasible != two.feasible
        assert two.feasible >= one.feasible
    assert differ >= 1


@pytest.mark.parametrize("planner", PROGRAMS)
@pytest.mark.parametrize("model", MODELS)
def test_plans_keep_their_problem(planner: str, model: str) -> None:
    asked = problem(stones(0.1, rise=0.1, model=model))
    plan = PROGRAMS[planner](asked)
    assert plan.status == "feasible"
    assert plan.last_feasible_step == plan.last_feasible_phase == len(asked) - 1  # its former name
    assert certify(asked, plan).certified
    assert (plan.com is None) == (model == "feet")


@pytest.mark.parametrize("planner", PROGRAMS)
@pytest.mark.parametrize("model", MODELS)
def test_verdicts_do_not_depend_on_where_and_whither(planner: str, model: str) -> None:
    for seed in range(4):
        described = random_world(seed, model)
        here = PROGRAMS[planner](problem(described), diagnose=False)
        for angle, shift in ((0.7, [3.0, -2.0, 1.0]), (-2.5, [0.0, 40.0, 0.0])):
            there = moved(described, angle, np.array(shift))
            assert PROGRAMS[planner](problem(there), diagnose=False).status == here.status


@pytest.mark.parametrize("model", MODELS)
def test_more_candidates_and_more_reach_never_hurt(model: str) -> None:
    for seed in range(8):
        described = random_world(seed, model)
        feasible = plan_mip(problem(described), diagnose=False).feasible
        free = problem(described).without_guide()
        assert plan_mip(free, diagnose=False).feasible >= feasible
        longer = {**described, "polytopes": {**described["polytopes"], **boxes(step=0.4)}}
        for name in ("COM_in_LF", "COM_in_RF"):
            longer["polytopes"][name] = described["polytopes"][name]
        assert plan_mip(problem(longer), diagnose=False).feasible >= feasible


@pytest.mark.parametrize("model", MODELS)
def test_the_least_gap_that_cannot_be_stepped_over(model: str) -> None:
    """Feet alternate: each stone is 0.2 long, a step 0.3, hence two steps cross 0.6 m."""
    start, goal = rectangle(-0.5, 0.1, -0.5, 0.5), lambda gap: rectangle(gap, 2, -0.5, 0.5)
    for gap, feasible in ((0.399, True), (0.401, False)):
        described = content({"a": start, "b": goal(gap)}, [["a"], ["b"]], model)
        assert plan_mip(problem(described), diagnose=False).feasible == feasible
        assert plan_sl1m(problem(described), diagnose=False).feasible == feasible


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("planner", PROGRAMS)
def test_the_last_step_that_can_be_made(planner: str, model: str) -> None:
    for good in range(4):
        surfaces = {f"s{k}": rectangle(0.15 * k - 0.05, 0.15 * k + 0.25, -0.3, 0.3) for k in (0, 1)}
        surfaces |= {f"s{k}": rectangle(0.2 * k, 0.2 * k + 0.1, -0.3, 0.3) for k in range(2, 5)}
        surfaces["far"] = rectangle(5, 6, -1, 1)
        names = [[f"s{k}"] for k in range(4)]
        names[good] = ["far"]
        asked = problem(content(surfaces, names, model))
        plan = PROGRAMS[planner](asked)
        assert plan.status == "infeasible"
        assert plan.last_feasible_step == good - 1
        assert not plan.feasible
        assert f"step {good}" in plan.reason


def test_dichotomic_search_asks_few_questions() -> None:
    asked = problem(content({"a": rectangle(-1, 1, -1, 1)}, [["a"]] * 50))
    for last in (-1, 0, 7, 24, 48):
        questions = []

        def judge(prefix, last=last, questions=questions):
            questions.append(len(prefix))
            return "optimal" if len(prefix) <= last + 1 else "infeasible"

        assert last_feasible_step(asked, judge) == last
        assert len(questions) <= 6
        late = lambda prefix: "time_limit"  # noqa: E731
    assert last_feasible_step(asked, late) is None


def test_the_reason_says_how_much_is_missing() -> None:
    described = content(
        {"a": rectangle(-0.5, 0.0, -0.5, 0.5), "b": rectangle(0.34, 1, -0.5, 0.5)}, [["b"]]
    )
    plan = plan_mip(problem(described))
    assert plan.last_feasible_step == -1
    assert "step 0 (LF onto 'b') is the first step that cannot be made" in plan.reason
    assert "with at most 0.05 m more reach of the step" in plan.reason
    assert "onto 'a', which is not among its candidates" in plan.reason


@pytest.mark.parametrize(
    ("polytope", "bound", "family"),
    [
        ("COM_in_LF", [0.4, 0.4, 0.4, 0.4, 1.0, -0.6], "step"),
        ("COM_in_LF", [0.4, 0.13, 0.4, 0.4, 1.0, -0.6], "com_reach"),
    ],
)
def test_the_family_to_blame(polytope: str, bound: list[float], family: str) -> None:
    """A step of 0.28 m, or where the step is short enough, a centre of mass that lags behind."""
    x = 0.34 if family == "step" else 0.28
    surfaces = {"a": rectangle(-0.5, 0.0, -0.5, 0.5), "b": rectangle(x, 1, -0.5, 0.5)}
    described = content(surfaces, [["b"]])
    described["polytopes"] = {**boxes(), polytope: {"A": boxes()[polytope]["A"], "b": bound}}
    blame = find_blame(problem(described))
    assert family in blame.short
    other = {"step": "com_reach", "com_reach": "step"}[family]
    assert other not in blame.short
    assert blame.short["edges"] <= 0.1


def test_a_long_way_needs_the_reaches_together() -> None:
    """A step of 1.5 m: neither reach alone would do."""
    surfaces = {"a": rectangle(-0.5, 0.0, -0.5, 0.5), "b": rectangle(1.5, 2, -0.5, 0.5)}
    blame = find_blame(problem(content(surfaces, [["b"]])))
    assert "step" not in blame.short
    assert blame.short["together"] == 2.0
    assert blame.short["edges"] == 2.0
    assert blame.in_time


def test_an_explanation_that_runs_late_says_so() -> None:
    """What was not found in time is not said to be of no help."""
    asked = problem(stones(0.45))
    last = plan_mip(asked).last_feasible_step
    assert last is not None
    late = explain(asked, last + 1, deadline=time.perf_counter())
    assert "the time ran out" in late
    assert "does not help" not in late


@pytest.mark.parametrize("cost", ["linear", "quadratic"])
def test_a_cost_draws_the_feet_to_the_guide(cost: str) -> None:
    described = stones(0.1)
    for index, phase in enumerate(described["phases"]):
        phase["root"] = [0.1 + 0.2 * index, 0.02, 0.95]
    asked = problem(described)
    targets = np.array([phase.root[:2] for phase in asked.steps])
    side = np.where([p.foot == "LF" for p in asked.steps], 0.0848, -0.0848)
    targets += np.stack([np.zeros(len(side)), side], axis=1)

    def distance(plan) -> float:
        away = plan.footholds[:, :2] - targets
        return float(np.abs(away).sum() if cost == "linear" else np.square(away).sum())

    free, drawn = plan_mip(asked), plan_mip(asked, cost=cost)
    assert certify(asked, drawn).certified
    assert distance(drawn) < 0.8 * distance(free)
    rng = np.random.default_rng(0)
    for _ in range(200):  # no certified plan nearby is better
        other = drawn.but(footholds=drawn.footholds + rng.normal(0, 0.01, (4, 3)) * [1, 1, 0])
        if certify(asked, other).certified:
            assert distance(other) > distance(drawn) - 1e-4


def test_a_cost_needs_a_guide() -> None:
    with pytest.raises(InputError, match="step 0 has no root"):
        plan_mip(problem(stones(0.1)), cost="linear")


@pytest.mark.parametrize("planner", PROGRAMS)
def test_a_time_limit_is_no_verdict(planner: str) -> None:
    begin = time.perf_counter()
    for described in (stones(0.1), stones(0.1, rise=0.1), random_world(1, "feet")):
        plan = PROGRAMS[planner](problem(described), time_limit=1e-6)
        assert plan.status == "time_limit"
        assert not plan.feasible
        assert "not decided within the time limit" in plan.reason
        assert plan.last_feasible_step is None
    assert time.perf_counter() - begin < 20.0


@pytest.mark.parametrize("planner", PROGRAMS)
@pytest.mark.parametrize("limit", [0.0, -1.0, float("nan")])
def test_a_time_limit_must_be_positive(planner: str, limit: float) -> None:
    with pytest.raises(InputError, match="positive number of seconds"):
        PROGRAMS[planner](problem(stones(0.1)), time_limit=limit)
