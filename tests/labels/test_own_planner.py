"""A contact planner of the user's own, from a module in the working folder to verdicts."""

import json
import sys
from dataclasses import replace

import numpy as np
import pytest

from jaxleas import cli
from jaxleas.contacts.own_planner import judge_by_own
from jaxleas.contacts.planner_settings import settings_from
from jaxleas.contacts.registry import find_planner, permit
from jaxleas.distillation.config import DistillationConfig
from jaxleas.distillation.folder import DistillationFolder
from jaxleas.distillation.opening import open_folder
from jaxleas.files import read_json
from jaxleas.guide.files import write_guide_paths
from jaxleas.labels import Judge, Outcome, OwnPlanner, PlannerAnswer, read_verdicts
from jaxleas.robots import load_talos, robot_digest, write_robot
from jaxleas.surrogates.label_files import read_labels
from jaxleas.terrain.scene_file import write_scene
from jaxleas.types import Cause, InputError
from tests.contacts.sampling.worlds import hole, straight

# Gets as far as the ground goes under the root; its answers can be spoilt.
MODULE = """
import numpy as np
from jaxleas.labels import Outcome, OwnPlanner

class Walker(OwnPlanner):
    keep_every: int = 4
    furthest: float = 1.0

    def judge(self, scene, path):
        far = np.flatnonzero(path.position[:, 0] > self.furthest)
        if len(far) == 0:
            return Outcome(len(path) - 1, steps=len(path) // self.keep_every)
        return Outcome(int(far[0]) - 1, steps=2, reason="too far")

something = 3
"""
PATHS = [straight(0.4 + 0.5 * n, y=0.1 * n) for n in range(5)]


@pytest.fixture
def here(tmp_path, monkeypatch):
    (tmp_path / "walkers_of_mine.py").write_text(MODULE)
    write_guide_paths(tmp_path / "walks.npz", PATHS, ["reached"] * 5)
    write_scene(tmp_path / "hole.json", hole())
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", [*sys.path])
    yield tmp_path
    sys.modules.pop("walkers_of_mine", None)


NAME = "walkers_of_mine:Walker"
COMMAND = ["label", "walks.npz", "--scene", "hole.json", "--planner", NAME]


def expected(furthest: float) -> list[int]:
    """Return last indices, one loop a path."""
    found = []
    for path in PATHS:
        last = len(path) - 1
        for index, (x, _, _) in enumerate(path.position):
            if x > furthest:
                last = index - 1
                break
        found.append(last)
    return found


def test_it_labels_and_its_labels_are_read(here) -> None:
    cli.run([*COMMAND, "--parameters", "furthest=1.21", "--out", "labels", "--processes", "1"])
    found = read_verdicts("labels")
    assert [verdict.last_index for _, verdict in found] == expected(1.21)
    successes = [verdict.success for _, verdict in found]
    assert successes == [last == len(p) - 1 for last, p in zip(expected(1.21), PATHS, strict=True)]
    assert {*successes} == {True, False}
    provenance = found[0][0]
    assert provenance["planner"] == NAME
    assert provenance["parameters"] == {"keep_every": 4, "furthest": 1.21}
    labels = read_labels([here / "labels"], [here], 0.1)
    assert (labels.planner, len(labels.paths)) == (NAME, 5)
    for number, (path, last) in enumerate(zip(PATHS, expected(1.21), strict=True)):
        reached = sum(index <= last for index in range(0, len(path), 4))
        whole = last == len(path) - 1
        assert labels.paths.failed_at[number] == (-1 if whole else reached)


def test_changed_code_or_settings_are_not_mixed_in(here) -> None:
    cli.run([*COMMAND, "--out", "labels", "--processes", "1"])
    with pytest.raises(InputError, match="made with other parameters"):
        cli.run([*COMMAND, "--parameters", "furthest=0.5", "--out", "labels"])
    (here / "walkers_of_mine.py").write_text(MODULE + "\n# changed\n")
    with pytest.raises(InputError, match="made with other source"):
        cli.run([*COMMAND, "--out", "labels"])


def test_workers_elsewhere_import_it_too(here) -> None:
    settings = settings_from(find_planner(NAME, [NAME]), furthest=1.21)
    with Judge(NAME, settings, processes=2, robot="talos") as judge:
        verdicts = judge.judge([hole()], PATHS, [0] * 5)
    assert [verdict.last_index for verdict in verdicts] == expected(1.21)


class Spoilt(OwnPlanner):
    answer: int = 0

    def judge(self, scene, path):
        return [
            {"last_index": 3},
            PlannerAnswer(last_index=len(path)),
            PlannerAnswer(last_index=-2, reason="no"),
            PlannerAnswer(last_index=1.5, reason="no"),
            PlannerAnswer(last_index=len(path) - 1, reason="but still"),
            PlannerAnswer(last_index=2),
            PlannerAnswer(last_index=2, steps=-1, reason="no"),
            PlannerAnswer(last_index=2, decided=False),
            PlannerAnswer(last_index=2, reason="no", cause="bad luck"),
            PlannerAnswer(last_index=2, reason="no", cause="time_limit"),
            PlannerAnswer(last_index=len(path) - 1, cause="no_contact"),
        ][self.answer]


@pytest.mark.parametrize(
    ("answer", "message"),
    enumerate(
        [
            "judge returned dict, not jaxleas.labels.PlannerAnswer",
            r"last_index is \d+, but it should be -1 to",
            "last_index is -2, but it should be",
            "last_index is 1.5, not a whole number",
            "the reason is 'but still'",
            "the reason is ''",
            "steps is -1",
            "the reason is ''",
            "cause is 'bad luck', but it should be one of no_start, ",
            "the cause is 'time_limit'",
            "the cause is 'no_contact'",
        ]
    ),
)
def test_an_answer_that_cannot_be_is_refused(answer: int, message: str) -> None:
    with pytest.raises(InputError, match=rf"Spoilt on guide path 7: {message}"):
        judge_by_own(hole(), PATHS[0], Spoilt(answer=answer), 7)


def test_what_is_counted(here) -> None:
    planner = find_planner(NAME, [NAME]).settings(furthest=1.21)
    path = PATHS[-1]
    verdict = judge_by_own(hole(), path, planner, 3)
    last = expected(1.21)[-1]
    kept = list(range(0, len(path), 4))
    assert verdict.reached == pytest.approx(sum(index <= last for index in kept) / len(kept))
    way = np.linalg.norm(np.diff(path.position[: last + 1], axis=0), axis=1).sum()
    assert verdict.mean_step == pytest.approx(way / 2)
    assert (verdict.path, verdict.length, verdict.success) == (3, len(path), False)
    assert verdict.cause == "other"


class Tired(OwnPlanner):
    cause: Cause | None = None
    decided: bool = True

    def judge(self, scene, path):
        return Outcome(1, reason="tired", decided=self.decided, cause=self.cause)


def test_an_answer_may_state_its_cause() -> None:
    """The class may still be called by its former name."""
    ask = lambda planner: judge_by_own(hole(), PATHS[0], planner)  # noqa: E731
    assert ask(Tired(cause="collision")).cause == "collision"
    late = ask(Tired(decided=False))
    assert (late.decided, late.cause) == (False, "time_limit")


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("nowhere_at_all:Walker", "cannot be loaded: No module named 'nowhere_at_all'"),
        ("walkers_of_mine:Runner", "cannot be loaded: module 'walkers_of_mine' has no attribute"),
        ("walkers_of_mine:something", "is not a planner: derive a class from"),
        ("walkers_of_mine:", "cannot be loaded"),
        (":Walker", "cannot be loaded"),
        ("walker", "there is no planner 'walker'; there are sampling, mip, sl1m, astar, or"),
    ],
)
def test_a_planner_that_is_none_is_refused(here, name: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        cli.run(["label", "walks.npz", "--scene", "hole.json", "--planner", name, "--out", "x"])
    assert not (here / "x").exists()


@pytest.mark.parametrize(
    ("given", "message"),
    [
        (["furthest=far"], "--furthest far: input should be a valid number"),
        (["nearest=1"], "has no setting nearest; it has "),
        (["furthest"], "they look like longest_step=0.3"),
        (["furthest=[1"], "is not YAML"),
    ],
)
def test_wrong_settings_are_refused(here, given: list[str], message: str) -> None:
    with pytest.raises(InputError, match=message.replace("[", r"\[")):
        cli.run([*COMMAND, "--out", "x", "--parameters", *given])


def test_a_file_alone_runs_no_code(here) -> None:
    (here / "evil.py").write_text("raise SystemExit('it ran')")
    (here / "d.yaml").write_text("planner: evil:Walker")
    with pytest.raises(
        InputError, match="which is code: if you trust it, give --allow evil:Walker"
    ):
        cli.run(["distill", "d.yaml", "--out", "out"])
    assert "evil" not in sys.modules
    with pytest.raises(InputError, match="asks for the planner evil:Walker, not for mip"):
        cli.run(["distill", "d.yaml", "--planner", "mip", "--out", "out"])
    assert not (here / "out").exists()
    assert permit(here / "d.yaml", "sampling", None) == ()
    assert permit(here / "d.yaml", "evil:Walker", None, ["evil:Walker"]) == ("evil:Walker",)
    assert permit(here / "d.yaml", "evil:Walker", "evil:Walker") == ("evil:Walker",)
    with pytest.raises(InputError, match="you allowed evil:Wakler: is one of the two misspelt"):
        permit(here / "d.yaml", "evil:Walker", None, ["evil:Wakler"])
    with pytest.raises(ValueError, match="planner"):
        DistillationConfig(planner="os.system")


def test_a_verdict_file_that_names_code_only_tells_its_name(here) -> None:
    cli.run([*COMMAND, "--out", "labels", "--processes", "1"])
    (file,) = (here / "labels").rglob("verdicts_*.json")
    content = read_json(file)
    content["provenance"]["planner"] = "evil:Walker"
    file.write_text(json.dumps(content))
    (here / "evil.py").write_text("raise SystemExit('it ran')")
    assert read_labels([here / "labels"], [here], 0.1).planner == "evil:Walker"
    assert "evil" not in sys.modules


def test_labels_record_their_robot(here) -> None:
    """A planner of one's own judges any robot; a surrogate of the labels is for that robot."""
    write_robot(here / "robots" / "walker.json", replace(load_talos(), name="walker"))
    cli.run([*COMMAND, "--robot", "walker", "--out", "labels", "--processes", "1"])
    provenance = read_verdicts("labels")[0][0]
    assert provenance["robot"] == {"name": "walker", "sha256": robot_digest("walker")}
    assert read_labels([here / "labels"], [here], 0.1).robot == "walker"
    with pytest.raises(InputError, match="made with other robot"):
        cli.run([*COMMAND, "--out", "labels"])
    with pytest.raises(InputError, match="there is no robot 'wlaker'"):
        cli.run([*COMMAND, "--robot", "wlaker", "--out", "other"])


def test_labels_from_before_robots_were_recorded_are_gone_on_with(here, capsys) -> None:
    cli.run([*COMMAND, "--out", "labels", "--processes", "1"])
    (file,) = (here / "labels").rglob("verdicts_*.json")
    content = read_json(file)
    del content["provenance"]["robot"]
    file.write_text(json.dumps(content))
    cli.run([*COMMAND, "--out", "labels", "--processes", "1"])
    assert "0 judged now" in capsys.readouterr().out


def test_a_setting_given_twice_is_refused(here) -> None:
    with pytest.raises(InputError, match="--keep-every and --parameters keep_every say the same"):
        cli.run([*COMMAND, "--keep-every", "3", "--parameters", "keep_every=4", "--out", "x"])


def test_the_workplace_of_a_distillation_imports_what_was_said_alone(here) -> None:
    config = DistillationConfig(planner=NAME)
    folder = DistillationFolder(here / "p2")
    with pytest.raises(InputError, match="is code: if you trust it"):
        open_folder(folder, config, None)
    assert "walkers_of_mine" not in sys.modules
    assert open_folder(folder, config, None, [NAME]) == config
    assert "walkers_of_mine" in sys.modules
