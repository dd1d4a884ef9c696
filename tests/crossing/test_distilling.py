"""Distilling a planner: lessons, their files, rounds that go on where they were interrupted."""

import contextlib
from dataclasses import replace

import numpy as np
import pytest

from jaxleas import cli
from jaxleas.controllers import find_controller
from jaxleas.crossing import COURSES, NotReachedError, WalkSettings, distilling, make_course
from jaxleas.crossing.distill_rounds import DistillSettings
from jaxleas.crossing.distilling import Distillation
from jaxleas.crossing.lesson_file import LessonNotes, LessonRows, read_lesson, write_lesson
from jaxleas.crossing.lesson_walk import DEEP, Pupil, School, Teacher
from jaxleas.crossing.lessons import make_lesson
from jaxleas.footsteps import (
    FootCostMap,
    FootstepPlanner,
    Goal,
    Node,
    ProposedPlanner,
    SearchSettings,
    motion_digest,
    read_proposal,
    shipped_model,
    write_proposal,
)
from jaxleas.physics import load_body
from jaxleas.terrain import HeightMap, Scene, write_scene
from jaxleas.types import InputError
from tests.footsteps.test_proposal import Favourite, drawn
from tests.footsteps.test_search import standing
from tests.terrain.test_scene_edges import rectangle

LEVEL = HeightMap(np.zeros((300, 300), np.float32), 0.02, (-3.0, -3.0))
SMALL = DistillSettings(rounds=1, lessons=8, more=2, robots=2, seconds=1.0, epochs=2)


class Levelled(School):
    """A school whose lessons are all on level ground."""

    def costs(self, lesson):
        return FootCostMap.of(LEVEL, 0.03)


@pytest.fixture(scope="module")
def school():
    body = load_body("anymal_b")
    walker = find_controller("trot", body)
    return Levelled(body, walker, shipped_model(walker.identity), WalkSettings(), 2, 0.5)


def choices(count=3, speed=0.5, seed=0):
    """Return choices of one speed in drawn states."""
    rng = np.random.default_rng(seed)
    feet = np.column_stack([standing().feet[:, :2], np.zeros(4)])
    nodes = [
        Node(np.zeros(2), yaw, rng.normal(size=4), feet, k % 2, np.zeros(3), np.zeros(3))
        for k, yaw in enumerate(rng.uniform(-1.0, 1.0, count).tolist())
    ]
    return [(node, Goal(2.0, 0.0), np.array([speed, 0.0, 0.0])) for node in nodes]


def test_lessons_are_drawn_by_number_and_are_no_courses():
    scenes = [make_lesson(number).course.scene for number in range(24)]
    again = make_lesson(7).course
    assert again.scene.surfaces.keys() == scenes[7].surfaces.keys()
    for name, surface in again.scene.surfaces.items():
        np.testing.assert_array_equal(surface, scenes[7].surfaces[name])
    judged = [make_course(name).scene for name in COURSES]
    assert not any(_same(lesson, course) for lesson in scenes for course in judged)
    kinds = {make_lesson(number).course.name.split("_")[0] for number in range(24)}
    assert kinds == {"stairs", "gaps", "blocks"}
    assert "stone_1" in scenes[19].surfaces


def _same(one, other):
    return one.surfaces.keys() == other.surfaces.keys() and all(
        np.array_equal(surface, other.surfaces[name]) for name, surface in one.surfaces.items()
    )


def test_a_file_holds_a_lesson(tmp_path):
    made = LessonRows.of(choices(), 4)
    notes = LessonNotes("key", "gaps_1", ("reached", "fell"), 10, 2)
    write_lesson(tmp_path / "lesson.npz", made, notes)
    found, known = read_lesson(tmp_path / "lesson.npz", "key")
    assert known == notes
    assert found.goal_of(1) == Goal(2.0, 0.0)
    node, expected = found.node(2), choices()[2][0]
    np.testing.assert_array_equal(node.velocity, expected.velocity)
    assert (node.pair, node.yaw) == (expected.pair, expected.yaw)
    assert len(LessonRows.of([], 4)) == 0
    with pytest.raises(InputError, match="other settings, motion models or proposal"):
        read_lesson(tmp_path / "lesson.npz", "other")


def test_a_teacher_answers_with_the_states_of_its_plan(school):
    costs, settings = school.costs(make_lesson(0)), WalkSettings().search
    planner = FootstepPlanner(school.model, costs, settings)
    alone = Teacher(planner, school.model, costs)
    goal = Goal(2.0, 0.0)
    plan = alone.plan(standing(), goal)
    assert len(plan.footsteps) == settings.horizon
    assert len(alone.chosen) == DEEP
    for (node, _, command), footstep in zip(alone.chosen, plan.footsteps, strict=False):
        np.testing.assert_array_equal(command, footstep.command)
        assert node.pair == footstep.pair
    np.testing.assert_allclose(alone.chosen[2][0].com, plan.footsteps[1].com)


def test_a_pupil_asks_its_teacher_where_it_must_and_now_and_then(school):
    costs, settings = school.costs(make_lesson(0)), SearchSettings(1)
    asked = []
    for sure, share in ((0.0, 0.5), (0.0, 0.0), (1.1, 0.0)):
        teacher = Teacher(FootstepPlanner(school.model, costs, settings), school.model, costs)
        slow = int(np.abs(school.model.commands() - (0.1, 0.0, 0.0)).sum(axis=1).argmin())
        proposed = ProposedPlanner(Favourite(slow), school.model, costs, settings, sure, teacher)
        pupil = Pupil(proposed, teacher, share, np.random.default_rng(0))
        for _ in range(20):
            pupil.plan(standing(), Goal(2.0, 0.0))
        asked.append((len(teacher.chosen), proposed.unsure))
    assert 4 < asked[0][0] < 16
    assert asked[1:] == [(0, 0), (20, 20)]


def test_rounds_go_on_where_they_were_interrupted(school, tmp_path, monkeypatch):
    walked = []

    def walk(school, lesson, proposal, key, shown):
        if len(walked) == 5:
            walked.append(None)
            raise KeyboardInterrupt
        walked.append((lesson.number, proposal is not None))
        outcomes = ("reached", "time")
        asked = 40 if proposal is not None else 0
        notes = LessonNotes(key, lesson.course.name, outcomes, asked, asked // 4)
        return LessonRows.of(choices(6, seed=lesson.number), 4), notes

    learned = []

    def fit(choices, model, settings):  # another test learns
        learned.append(len(choices))
        sizes = choices.commands.shape[2], choices.state.shape[1]
        known = {"controller": model.controller, "motion": motion_digest(model)}
        return drawn(sizes, seed=settings.seed, **known)

    monkeypatch.setattr(distilling, "walk_lesson", walk)
    monkeypatch.setattr(distilling, "fit_proposal", fit)
    said = []
    place = (tmp_path, school, SMALL, lambda number: None, said.append)
    with pytest.raises(KeyboardInterrupt):
        Distillation(*place).run()
    proposal, rounds = Distillation(*place).run()
    numbers = [each for each in walked if each is not None]
    assert numbers == [*((n, False) for n in range(8)), (8, True), (9, True)]
    counted = [(each.reached, each.robots, each.choices) for each in rounds]
    assert counted == [(8, 16, 48), (2, 4, 12)]
    said_last = "round 1: proposal 0 reached 2 of 4 goals, searched 25.0 %; 12 choices"
    assert rounds[1].in_words().startswith(said_last)
    again, _ = Distillation(*place).run()  # nothing is left to do
    assert len(walked) == 11
    assert learned == [7 * 6, 9 * 6]  # but for one lesson in eight
    np.testing.assert_array_equal(again.hidden, proposal.hidden)
    others = replace(school, settings=WalkSettings(jump=0.3))
    with pytest.raises(InputError, match="give another --out"):
        Distillation(tmp_path, others, SMALL, print, print).run()


@pytest.mark.parametrize(
    ("options", "says"),
    [
        ({"lessons": 4}, "at least 8, of which one is not learned from"),
        ({"robots": 0}, "give at least one"),
        ({"share": 0.0}, "a share above 0"),
        ({"seconds": 0.0}, "seconds 0"),
    ],
)
def test_settings_that_teach_nothing_are_refused(options, says):
    with pytest.raises(InputError, match=says):
        DistillSettings(**options)


@pytest.fixture(scope="module")
def floor(tmp_path_factory):
    file = tmp_path_factory.mktemp("proposal") / "floor.json"
    write_scene(file, Scene({"floor": rectangle(-1.2, 1.2, -1.0, 1.0)}))
    return file


def test_a_walk_asks_the_shipped_proposal(floor, capsys):
    goal = ("--goal", "0.4,0,0")
    cli.run(["gait", "walk", "--terrain", str(floor), *goal, "--proposal", "shipped"])
    said = capsys.readouterr().out
    assert "reached" in said
    assert "proposals; the planner searched for" in said


def test_proposals_of_others_are_refused(floor, tmp_path):
    shipped = read_proposal_of_trot()
    other = replace(shipped, controller=replace(shipped.controller, name="trot_high"))
    write_proposal(tmp_path / "other.npz", other)
    walk = ["gait", "walk", "--terrain", str(floor), "--goal", "0.4,0", "--proposal"]
    with pytest.raises(InputError, match=r"other\.npz is of another controller than the walk"):
        cli.run([*walk, str(tmp_path / "other.npz")])
    with pytest.raises(InputError, match="a blind walk asks no proposal"):
        cli.run([*walk, "shipped", "--blind", "0.4"])


def read_proposal_of_trot():
    from jaxleas.footsteps import shipped_proposal

    return shipped_proposal(find_controller("trot", load_body("anymal_b")).identity)


@pytest.mark.slow
def test_a_small_distillation_walks_learns_and_is_used(floor, tmp_path, capsys):
    small = "--rounds 1 --lessons 8 --more 1 --robots 1 --seconds 0.8 --epochs 1"
    out = tmp_path / "distilled"
    cli.run(["gait", "distill", "--out", str(out), *small.split()])
    assert {"proposal.npz", "proposal.onnx"} <= {each.name for each in out.iterdir()}
    proposal = read_proposal(out / "proposal.npz")
    assert len(proposal.provenance["rounds"]) == 2
    assert "round 1: proposal 0 reached" in capsys.readouterr().err
    walk = ["gait", "walk", "--terrain", str(floor), "--goal", "0.4,0,0", "--seconds", "2"]
    with contextlib.suppress(NotReachedError):  # it has hardly learned anything
        cli.run([*walk, "--proposal", str(out / "proposal.npz")])
    assert "proposals; the planner searched for" in capsys.readouterr().out
