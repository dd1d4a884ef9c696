"""Imitation of the search: its demonstrations are legal, are kept, and teach a policy."""

import json

import jax
import numpy as np
import pytest

from jaxleas import cli
from jaxleas.envs.gait_planning import STANDING, GaitPlanning
from jaxleas.gaits.demonstrations import collect
from jaxleas.gaits.imitation import imitate
from jaxleas.training import load_run_config, make_task, read_policy
from jaxleas.types import InputError

SHARES = "flat: 1, random_stairs: 0, gaps: 0, stones: 0, stairs: 0, temple: 0"
CONFIG = (
    "env: {task: gait_planning, snap: 0.08, goal_distance: [0.7, 1.2]}\n"
    f"terrain: {{arenas: 6, shares: {{{SHARES}}}, field: {{length: 4.0, width: 3.0}}}}\n"
    "network: {hidden: [32, 32], activation: elu}\n"
    "ppo: {steps: 512, environments: 64, unroll: 8, minibatches: 2, epochs: 1, candidates: 64}\n"
    "held_out: {every: 1, starts: 8, arenas: 6, steps: 8}\n"
)


@pytest.fixture(scope="module")
def shown(tmp_path_factory):
    folder = tmp_path_factory.mktemp("imitation")
    (folder / "gaits.yaml").write_text(CONFIG)
    config = load_run_config(folder / "gaits.yaml")
    task = make_task(config)
    assert isinstance(task, GaitPlanning)
    return folder, config, task, collect(task, folder / "parts", 120, seed=5)


def test_demonstrations_are_kept_and_read_back(shown):
    folder, _, task, first = shown
    files = {path: path.stat().st_mtime_ns for path in (folder / "parts").iterdir()}
    again = collect(task, folder / "parts", 120, seed=5)
    assert len(files) == 2
    assert files == {path: path.stat().st_mtime_ns for path in (folder / "parts").iterdir()}
    for name, column in vars(first).items():
        np.testing.assert_array_equal(getattr(again, name), column)


def test_demonstrations_of_another_configuration_are_refused(shown):
    folder, _, task, _ = shown
    other = GaitPlanning(task.config.model_copy(update={"snap": 0.05}), task.worlds)
    with pytest.raises(InputError, match="another configuration"):
        collect(other, folder / "parts", 60, seed=5)


def test_feet_that_are_placed_are_those_that_do_not_stand_before_and_after(shown):
    *_, task, rows = shown
    contacts = rows.observation[:, 11:15] > 0.0  # attitude 1, velocity 2, feet 8, then contacts
    np.testing.assert_array_equal(rows.placed, ~(contacts & STANDING[rows.support]))
    assert (np.abs(rows.numbers) <= 1.0).all()
    assert rows.observation.shape[1] == task.signature.size


def test_a_policy_foretells_the_support_better_than_the_commonest_one(shown):
    _, config, task, rows = shown
    losses = []
    policy = imitate(config, task, rows, 120, lambda done, loss: losses.append(loss))
    action = policy.signature.mode(policy.answer_vector(rows.observation))
    right = np.mean(np.asarray(action)[:, -1] == rows.support)
    assert right > np.bincount(rows.support).max() / len(rows) + 0.1
    assert losses[-1] < losses[0]


def test_too_few_demonstrations_are_refused(shown):
    _, config, task, rows = shown
    few = type(rows)(*(column[:100] for column in vars(rows).values()))
    with pytest.raises(InputError, match="100 transitions are too few"):
        imitate(config, task, few, 1)


@pytest.mark.slow
def test_a_training_begins_with_the_policy(shown):
    folder, *_ = shown
    imitated = ["--out", str(folder / "out"), "--starts", "120", "--passes", "2"]
    cli.run(["gait", "imitate", str(folder / "gaits.yaml"), *imitated])
    begin = str(folder / "out/policy.npz")
    train = ["train", str(folder / "gaits.yaml"), "--final.evaluate", "false", "--begin", begin]
    slow = ["--ppo.learning_rate", "1e-9", "--ppo.final_learning_rate", "0"]
    with jax.numpy_rank_promotion("allow"):  # Brax's normaliser relies on it
        cli.run([*train, *slow, "--run-dir", str(folder / "run")])
    before, after = (read_policy(path).params for path in (begin, folder / "run/policy.npz"))
    jax.tree.map(lambda *each: np.testing.assert_allclose(*each, atol=1e-5), before, after)
    assert json.loads((folder / "run/metrics.jsonl").read_text().splitlines()[0])["step"] == 512
    with pytest.raises(InputError, match="of other sizes"):
        cli.run([*train, "--network.hidden", "[16]", "--run-dir", str(folder / "other")])
    assert not (folder / "other").exists()
