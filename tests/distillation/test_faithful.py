"""The exact planner in the loop: walks, staleness, workers that die, interruption and resume."""

import os
import signal
from itertools import islice

import jax
import numpy as np
import pytest

from jaxleas.distillation.config import DistillationConfig, FaithfulConfig
from jaxleas.distillation.episodes import to_host
from jaxleas.distillation.faithful import Faithful, staleness_bound
from jaxleas.distillation.faithful_practice import practise_faithfully
from jaxleas.distillation.folder import RoundFolder
from jaxleas.distillation.labelling import Ground
from jaxleas.distillation.practice import read_run
from jaxleas.envs.steering import Steering
from jaxleas.envs.steering.env import SteeringEnv
from jaxleas.labels import Judge, ProcessWorkers, Verdict
from jaxleas.runs.metrics import read_metrics
from jaxleas.terrain.generator import generate_arena
from jaxleas.training.normaliser import normalise
from jaxleas.training.stretches import InterruptedRunError
from jaxleas.training.train_state import Learned
from jaxleas.training.worlds import training_world

from ..training.runs import tiny

pytestmark = pytest.mark.usefixtures("brax_ranks")
FAITHFUL = FaithfulConfig(robots=16, ahead=1)
STEPS = 30


def small(updates):
    base = tiny(steps=updates * 640)
    env = base.env.model_copy(update={"episode_steps": STEPS})
    held_out = base.held_out.model_copy(update={"every": 100})
    return base.model_copy(update={"env": env, "held_out": held_out})


CONFIG = small(3)


class Strict:
    """Judges as a planner would that fails every third guide path after its first stretch."""

    def __init__(self, after_each=lambda calls: None):
        self.asked, self.calls, self.after_each = [], 0, after_each

    def judge(self, scenes, paths, scene_index, on_done=lambda count: None):
        assert len(paths) == len(scene_index)
        self.asked += [path.position for path in paths]
        self.calls += 1
        self.after_each(self.calls)
        return [self.verdict(number, path) for number, path in enumerate(paths)]

    def verdict(self, number, path):
        good = number % 3 > 0 or len(path) < 7
        last = len(path) - 1 if good else 5
        return Verdict(
            number, True, good, last, len(path), 1.0, 0, *[None] * 6, "" if good else "no", 0.01
        )


@pytest.fixture(scope="module")
def ground():
    scenes = tuple(generate_arena(CONFIG.terrain.generator, seed).scene for seed in range(2))
    return Ground(
        SteeringEnv(CONFIG.env),
        training_world(CONFIG, Steering(CONFIG.env, CONFIG.terrain)),
        scenes,
    )


def make(ground, faithful):
    task = Steering(CONFIG.env, CONFIG.terrain)
    return Faithful(CONFIG, faithful, task, ground.world, ground.scenes, Strict())


@pytest.fixture(scope="module")
def training(ground):
    """One training, whose compiled functions all tests here share."""
    with jax.numpy_rank_promotion("allow"):
        return make(ground, FAITHFUL)


def run(training, judge, stop=lambda: False):
    """Train from fresh networks; return parameters, metrics and update after each update."""
    training.judge = judge
    told = list(islice(training.updates(training.fresh_state(None), stop), CONFIG.ppo.updates))
    return told[-1][0], [metrics for _, metrics in told]


def same(one, other):
    for a, b in zip(jax.tree.leaves(one.params), jax.tree.leaves(other.params), strict=True):
        np.testing.assert_array_equal(a, b)


def test_whole_episodes_are_walked_and_remember_who_walked_them(training, ground):
    state = training.fresh_state(None)
    episodes = to_host(training._walk(ground.world, state, jax.random.key(5)))
    valid = episodes.walks.valid
    assert len(episodes) == FAITHFUL.robots
    for robot, steps in enumerate(episodes.steps.tolist()):
        ended = episodes.terminated[robot, steps - 1]
        assert ended or steps == STEPS
        assert not episodes.terminated[robot, : steps - 1].any()
        assert valid[robot].sum() == steps + 1 - ended
        assert valid[robot, : steps + 1 - ended].all()
    seen = normalise(episodes.observation, state.normaliser)
    logits = training.networks.plain(state.params.policy, seen)
    (normal,) = training.networks.signature.distributions(logits)
    np.testing.assert_allclose(episodes.location, normal.location, atol=1e-5)
    np.testing.assert_allclose(episodes.deviation, normal.deviation, atol=1e-5)
    assert episodes.failure_cost == pytest.approx(CONFIG.env.reward.alive)


def test_it_learns_from_what_the_planner_accepts_and_stays_within_its_staleness(training):
    judge = Strict()
    state, metrics = run(training, judge)
    assert int(state.update) == 3
    assert all(each["planner/failures_per_1000_steps"] > 0.0 for each in metrics)
    bound = staleness_bound(CONFIG, FAITHFUL)
    assert bound == 2
    assert 0 < max(each["planner/staleness_most"] for each in metrics) <= bound
    walked = sum(each["planner/guides"] for each in metrics if "planner/guides" in each)
    assert FAITHFUL.robots * (judge.calls - FAITHFUL.ahead - 1) <= walked <= len(judge.asked)
    again, _ = run(training, Strict())
    same(state, again)


def test_no_wave_ahead_means_nothing_is_older_than_its_batch(training, ground):
    alone = make(ground, FaithfulConfig(robots=16, ahead=0))
    alone._walk, alone._update = training._walk, training._update
    _, metrics = run(alone, Strict())
    assert max(each["planner/staleness_most"] for each in metrics) <= 1


@pytest.mark.slow
def test_when_workers_die_the_training_is_the_same(training):
    def with_workers(on_call):
        workers = ProcessWorkers(2)
        judge = Judge("sl1m", workers=workers, robot="talos")
        whole = judge.judge

        def watched(*arguments):
            return whole(*arguments, on_done=lambda count: on_call(workers))

        judge.judge = watched  # type: ignore[method-assign]
        try:
            return run(training, judge)
        finally:
            judge.close()

    killed = []

    def kill(workers):
        if len(killed) < 2:
            killed.append(workers.pids[0])
            os.kill(workers.pids[0], signal.SIGKILL)

    undisturbed, before = with_workers(lambda workers: None)
    disturbed, after = with_workers(kill)
    assert len(killed) == 2
    same(undisturbed, disturbed)
    for one, other in zip(before, after, strict=True):
        assert one["planner/guides"] == other["planner/guides"]
        assert one["planner/passed"] == other["planner/passed"]


def test_an_interrupted_practice_resumes_from_what_it_learned(training, tmp_path):
    folder = RoundFolder(tmp_path / "out" / "round_1")
    learned = Learned.of(training.fresh_state(None))

    log, sent = folder.run / "metrics.jsonl", []

    def interrupt(calls):
        if log.is_file() and log.stat().st_size and not sent:  # the first update is written
            sent.append(calls)
            os.kill(os.getpid(), signal.SIGINT)

    training.judge = Strict(interrupt)
    with pytest.raises(InterruptedRunError, match="the same command resumes in"):
        practise_faithfully(folder, training, learned)
    assert not folder.practised.exists()
    rows = read_metrics(folder.run / "metrics.jsonl")
    assert 0 < len(rows) < 3
    _, saved = read_run(folder.run)
    training.judge = Strict()
    practise_faithfully(folder, training, learned)
    assert folder.practised.exists()
    after = read_metrics(folder.run / "metrics.jsonl")
    assert [row["step"] for row in after] == [640, 1280, 1920]
    assert after[: len(rows)] == rows
    moved = jax.tree.map(lambda a, b: np.any(a != b), saved.params, read_run(folder.run)[1].params)
    assert any(jax.tree.leaves(moved))


def test_the_mode_is_named_in_the_configuration():
    assert DistillationConfig().mode == "surrogate"
    config = DistillationConfig.model_validate({"mode": "faithful", "faithful": {"ahead": 3}})
    assert config.faithful.ahead == 3


class Dizzy(Strict):
    """A planner with a known rule: it fails at the first turn of more than 0.03 rad a step."""

    def verdict(self, number, path):
        turn = np.abs((np.diff(path.yaw) + np.pi) % (2 * np.pi) - np.pi)
        quick = np.flatnonzero(turn > 0.03)
        last = int(quick[0]) if len(quick) else len(path) - 1
        good = not len(quick)
        return Verdict(number, True, good, last, len(path), 1.0, 0, *[None] * 6, "", 0.01)


@pytest.mark.slow
def test_a_policy_learns_to_avoid_what_its_planner_cannot_do(ground):
    config = small(16)
    ppo = config.ppo.model_copy(update={"learning_rate": 1e-2, "epochs": 4})
    reward = config.env.reward.model_copy(update={"failure": 10.0, "final_failure": 10.0})
    env = config.env.model_copy(update={"reward": reward})
    config = config.model_copy(update={"ppo": ppo, "env": env})
    robots = FaithfulConfig(robots=32)
    task = Steering(config.env, config.terrain)
    training = Faithful(config, robots, task, ground.world, ground.scenes, Dizzy())
    told = islice(training.updates(training.fresh_state(None)), config.ppo.updates)
    failures = [metrics["planner/failures_per_1000_steps"] for _, metrics in told]
    assert failures[0] > 450
    assert np.mean(failures[-3:]) < 0.85 * failures[0]
