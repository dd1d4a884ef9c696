"""Each mistake in a task of one's own is one sentence, before anything is written."""

from types import SimpleNamespace

import jax.numpy as jnp
import pytest

from jaxleas.configuration.own_code import methods_of
from jaxleas.envs.environment import Task
from jaxleas.envs.registry import TASKS
from jaxleas.envs.task_values import Examination
from jaxleas.sweeps.border import open_sweep
from jaxleas.sweeps.job import do_job
from jaxleas.sweeps.job_files import read_outcome, write_job
from jaxleas.sweeps.sweep import run_sweep
from jaxleas.training.loop import _Session
from jaxleas.training.rehearsal import rehearse
from jaxleas.training.run_config import load_run_config
from jaxleas.types import InputError

from .configs import DRIFT, MAZE, write
from .drift import Drift, DriftConfig
from .maze import Maze


@pytest.fixture(scope="module")
def configs(tmp_path_factory):
    """The probes' configurations, with few robots."""
    folder = tmp_path_factory.mktemp("careless")
    few = ["--ppo.environments", "8", "--ppo.candidates", "16", "--ppo.unroll", "3"]
    few += ["--held_out.starts", "4"]
    return {
        base: load_run_config(write(folder, name), few, allow=[name])
        for base, name in ((Drift, DRIFT), (Maze, MAZE))
    }


def rehearsed(configs, base, **changes):
    """Rehearse a probe some of whose methods are replaced."""
    config = configs[base]
    careless = type("Careless", (base,), changes)(config.env, config.terrain)
    rehearse(config, careless)


def changed(base, method, change):
    """Return a method whose answer is changed."""

    def answer(self, *arguments, **options):
        return change(getattr(base, method)(self, *arguments, **options))

    return {method: answer}


def of_state(change):
    return lambda answer: (answer[0] | change(answer[0]), answer[1])


def of_result(**change):
    def put(answer):
        values = {name: each(answer[1]) for name, each in change.items()}
        return answer[0], answer[1].replace(**values)

    return put


def of_starts(**change):
    return lambda starts: starts.replace(**{name: each(starts) for name, each in change.items()})


@pytest.mark.parametrize("base", [Drift, Maze])
def test_a_sound_task_is_accepted(configs, base):
    rehearsed(configs, base)


DEVICE = [
    ("look", lambda seen: {"offset": seen["offset"]}, "look gives offset, but the parts"),
    ("look", lambda seen: seen | {"plase": seen["place"]}, "plase.*offset, place: give the same"),
    ("look", lambda seen: seen["offset"], "look gives an array; give arrays by part"),
    ("look", lambda seen: None, "look gives None"),
    (
        "look",
        lambda seen: seen | {"place": seen["place"][0]},
        r"part place is of shape \(2,\); here \(8, 2\)",
    ),
    ("advance", lambda answer: answer[1], "advance gives a StepResult; give two"),
    ("advance", lambda answer: answer[::-1], "advance gives a StepResult, a dict; give two"),
    ("advance", of_state(lambda s: {"step": s["step"].astype(int)}), r"\['step'\] is int32"),
    ("advance", of_state(lambda s: {"more": s["step"]}), r"the state adds \['more'\]"),
    ("advance", lambda answer: ({"step": answer[0]["step"]}, answer[1]), "the state lacks"),
    ("advance", of_result(reward=lambda r: r.reward[:, None]), r"reward is of shape \(8, 1\)"),
    ("advance", of_result(reward=lambda r: r.reward.mean()), r"reward is of shape \(\)"),
    ("advance", of_result(reward=lambda r: r.reached), "reward is of type bool; give numbers"),
    ("advance", of_result(reached=lambda r: None), "reached is None; give an array"),
    ("advance", of_result(terminated=lambda r: False), r"terminated is of shape \(\)"),
    ("advance", of_result(reached=lambda r: r.reward), "reached is of type float32"),
    ("advance", of_result(measures=lambda r: {"reward": r.reward}), "a measure has the name 'rew"),
    ("advance", of_result(measures=lambda r: {3: r.reward}), "a measure has the name 3"),
    ("advance", of_result(measures=lambda r: [r.reward]), "measures is a list"),
    ("draw_starts", lambda starts: starts.state, "draw_starts gives a dict; give Starts"),
    ("draw_starts", of_starts(group=lambda s: s.group + 1), "gives the group 2, but"),
    ("draw_starts", of_starts(group=lambda s: s.group - 1), "gives the group -1, but"),
    ("draw_starts", of_starts(group=lambda s: s.group * 1.0), "group is of type float32"),
    ("draw_starts", of_starts(valid=lambda s: s.valid & False), "none of which is valid"),
    ("draw_starts", of_starts(valid=lambda s: s.valid[:3]), r"valid is of shape \(3,\)"),
    (
        "draw_starts",
        of_starts(state=lambda s: s.state | {"step": s.state["step"][:3]}),
        r"state\['step'\] is of shape \(3, 1\); give \[candidates, ...\]",
    ),
    ("draw_starts", of_starts(state=lambda s: ()), "holds no arrays"),
    (
        "draw_disturbances",
        lambda drawn: drawn.swapaxes(0, 1),
        r"\(8, 3, 2\); give \[steps, robots, ...\], here \[3, 8",
    ),
    ("draw_disturbances", lambda drawn: None, "draw_disturbances is None"),
    ("stagger", lambda state: None, r"stagger: the state lacks"),
    ("make_world", lambda world: world | {"name": "pond"}, r"make_world\['name'\] is a str"),
    ("examination", lambda asked: None, "examination gives None"),
    ("examination", lambda asked: Examination(4, 5, ("clam",)), "clam.*near, far"),
    ("examination", lambda asked: Examination(4, 5, "near"), "give a tuple of groups"),
    ("examination", lambda asked: Examination(0, 5), "measures nothing"),
]


@pytest.mark.parametrize(("method", "change", "sentence"), DEVICE)
def test_a_wrong_answer_on_the_device(configs, method, change, sentence):
    with pytest.raises(InputError, match=rf"^the task {DRIFT}: .*{sentence}") as refusal:
        rehearsed(configs, Drift, **changed(Drift, method, change))
    assert "\n" not in str(refusal.value)


HOST = [
    ("look", lambda seen: seen | {"bias": seen["bias"][:, 0]}, r"bias is of shape \(8,\)"),
    ("look", lambda seen: seen | {"bias": None}, "the part bias is None"),
    ("advance", of_state(lambda s: {"step": s["step"] * 1.0}), r"\['step'\] is float64"),
    ("advance", of_result(reward=lambda r: list(r.reward[:2])), r"reward is of shape \(2,\)"),
    ("advance", of_result(terminated=lambda r: r.terminated * 1), "terminated is of type int64"),
    ("draw_starts", of_starts(valid=lambda s: s.valid & False), "none of which is valid"),
    ("draw_starts", of_starts(group=lambda s: s.group + 1), "gives the group 1, but"),
    (
        "draw_starts",
        of_starts(state=lambda s: s.state | {"sim": [object()]}),
        r"state\['sim'\]\[0\] is a object; give an array",
    ),
]


@pytest.mark.parametrize(("method", "change", "sentence"), HOST)
def test_a_wrong_answer_on_the_host(configs, method, change, sentence):
    with pytest.raises(InputError, match=rf"^the task {MAZE}: .*{sentence}"):
        rehearsed(configs, Maze, **changed(Maze, method, change))


def test_numbers_of_another_float_or_integer_type_do(configs):
    """NumPy makes float64 and int64 by itself, and a reward may count something."""
    rehearsed(configs, Maze, **changed(Maze, "advance", of_result(reward=lambda r: r.reward * 1)))
    whole = of_result(reward=lambda r: jnp.ones(8, jnp.int32))
    rehearsed(configs, Drift, **changed(Drift, "advance", whole))


def test_an_exception_says_where_it_was_raised(configs):
    def look(self, world, state):
        return self.lok(world, state)

    with pytest.raises(
        InputError, match=r"look raises AttributeError: .*'lok' \(test_careless\.py"
    ):
        rehearsed(configs, Drift, look=look)

    def advance(self, world, state, action, disturbance):
        raise AssertionError

    with pytest.raises(InputError, match=r"advance raises TypeError: .* positional arguments"):
        rehearsed(configs, Drift, advance=advance)


def test_disturbances_that_nobody_draws_are_named(configs):
    with pytest.raises(InputError, match=r"is_disturbed is False, raises TypeError"):
        rehearsed(configs, Drift, is_disturbed=False)


def test_an_exception_in_the_middle_of_a_training_is_a_sentence_too(configs):
    class Tired(Maze):
        def advance(self, world, weights, state, action, disturbance):
            raise RuntimeError("the solver\ngave up")

    task = Tired(configs[Maze].env, configs[Maze].terrain)
    sentence = r"^mine: advance raises RuntimeError: the solver \(test_careless\.py, line \d+\)"
    with pytest.raises(InputError, match=sentence), methods_of(task, "mine"):
        task.advance(*[None] * 5)
    with pytest.raises(RuntimeError, match="ours"), methods_of(task, "mine"):
        raise RuntimeError("ours")


class Unswept(DriftConfig):
    swept = ("fule",)


class OneName(DriftConfig):
    swept = "fuel"


class Wordy(DriftConfig):
    swept = ("task",)


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"Config": Unswept}, "Unswept.swept: there is no fule; perhaps you meant fuel"),
        ({"Config": OneName}, "OneName.swept is 'fuel'; give a tuple"),
        ({"Config": None}, "has the Config None"),
        ({"Config": SimpleNamespace}, "derived from jaxleas.envs.TaskConfig"),
        ({"Worlds": DriftConfig}, "has the Worlds .*WorldsConfig"),
        ({"groups": "near"}, "groups is 'near'; give a tuple"),
        ({"groups": ("near", "near")}, "give a tuple of different names"),
        ({"groups": ()}, r"groups is \(\)"),
        ({"advance": Task.advance}, "leaves out advance"),
    ],
)
def test_a_class_that_is_no_whole_task_is_refused(monkeypatch, changes, sentence):
    careless = type("Careless", (Drift,), changes)
    monkeypatch.setattr("tests.probes.drift.Drift", careless)
    with pytest.raises(InputError, match=sentence):
        TASKS.find(DRIFT, [DRIFT])


def test_what_is_no_number_is_not_swept(configs):
    config = configs[Drift].model_copy(update={"env": Wordy()})
    with pytest.raises(InputError, match="swept names task, which is 'tests"):
        rehearse(config, Drift(config.env, config.terrain))


def test_built_in_tasks_are_not_rehearsed(configs):
    env = configs[Drift].env.model_copy(update={"task": "steering"})
    rehearse(configs[Drift].model_copy(update={"env": env}), None)


def test_a_module_that_cannot_be_run_is_a_sentence(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name, text, sentence in (
        ("broken_by_zero", "x = 1 / 0", r"ZeroDivisionError: division by zero \(broken_by_zero.py"),
        ("broken_grammar", "x = = 1", "SyntaxError"),
        ("broken_import", "import numpyy", "No module named 'numpyy'"),
        ("broken_name", "class Ferry: pass", "perhaps you meant broken_name:Ferry"),
    ):
        (tmp_path / f"{name}.py").write_text(text)
        own = f"{name}:Fery"
        with pytest.raises(InputError, match=sentence):
            TASKS.find(own, [own])
    with pytest.raises(InputError, match="you allowed ferry:Fery"):
        TASKS.find("ferry:Ferry", ["ferry:Fery"])


def test_a_trial_of_a_sweep_fails_with_the_sentence_and_is_not_tried_again(
    configs, tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "careless_job.py").write_text(
        "from tests.probes.maze import Maze\n\n\n"
        "class Careless(Maze):\n    def stagger(self, state, key):\n        pass\n"
    )
    own = "careless_job:Careless"
    env = configs[Maze].env.model_copy(update={"task": own})
    config = configs[Maze].model_copy(update={"env": env})
    run = tmp_path / "seed_0"
    write_job(tmp_path / "job.json", [run], [config.model_dump_json()], [{"measure": "held_out"}])
    do_job(tmp_path / "job.json", [own])
    outcome = read_outcome(run)
    assert outcome is not None
    assert outcome.state == "failed"
    assert outcome.reason.startswith(f"the task {own}: stagger: the state lacks")


def test_a_sweep_of_a_careless_task_leaves_nothing_behind(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    own = "careless_sweep:Careless"
    (tmp_path / "careless_sweep.py").write_text(
        "from tests.probes.maze import Maze\n\n\n"
        "class Careless(Maze):\n    def stagger(self, state, key):\n        pass\n"
    )
    write(tmp_path, MAZE)
    few = "{ppo.environments: 8, ppo.candidates: 16, held_out.starts: 4}"
    base = (tmp_path / "maze.yaml").read_text().replace(MAZE, own)
    (tmp_path / "maze.yaml").write_text(base)
    (tmp_path / "sweep.yaml").write_text(
        f"config: maze.yaml\nset: {few}\ntrials: 1\nspace: {{ppo.discount: {{choices: [0.9]}}}}\n"
    )
    with pytest.raises(InputError, match=f"^the task {own}: stagger: the state lacks"):
        run_sweep(open_sweep("sweep.yaml", [own]), "out")
    assert not (tmp_path / "out").exists()


def test_starts_that_are_all_invalid_later_stop_the_training():
    _Session._require_starts(3, {"walk/valid_starts": 0.01})
    with pytest.raises(InputError, match="update 3: none of the starts"):
        _Session._require_starts(3, {"walk/valid_starts": 0.0})
