"""Starts of groups that fail often are drawn more often, on the device and on the host."""

import jax
import numpy as np
import pytest

from jaxleas.envs.environment import Task
from jaxleas.envs.heads import Interval, Normal
from jaxleas.envs.host_starts import HostPool
from jaxleas.envs.part import Part
from jaxleas.envs.signature import Signature
from jaxleas.envs.starts import draw_failing_picks, pool_of
from jaxleas.envs.task_config import TaskConfig, WorldsConfig
from jaxleas.envs.task_values import Starts, StepResult
from jaxleas.runs.checkpoints import Checkpoints
from jaxleas.training.config import RunConfig
from jaxleas.training.failures import Failures, counted, counted_on_host
from jaxleas.training.trainer import Trainer
from jaxleas.types import InputError

SMALL = {"steps": 96, "environments": 8, "unroll": 6, "minibatches": 2, "epochs": 1}


class BridgeConfig(TaskConfig):
    task: str = "bridge"

    def signature(self):
        return Signature((Part("place", (1,)),), (Normal("move", (Interval(-1.0, 1.0),)),))


class Bridge(Task):
    """Whatever it does, an episode on the bridge fails at once; one on the road is cut."""

    Config = BridgeConfig
    groups = ("road", "bridge")

    def make_world(self, seeds, examined):
        return ()

    def draw_starts(self, world, key, count, examined=False):
        kinds = np.arange(count, dtype=np.int32) % 4 == 0  # a quarter begins on the bridge
        state = {"bridge": kinds, "step": np.zeros(count, np.int32)}
        return Starts(state, np.arange(count) % 5 != 4, kinds.astype(np.int32))

    def advance(self, world, weights, state, action, disturbance):
        step = state["step"] + 1
        nothing = step < 0
        cut = ~state["bridge"] & (step >= 2)
        result = StepResult(0.0 * action[..., 0], state["bridge"], cut, nothing)
        return state | {"step": step}, result

    def look(self, world, state):
        return state["step"][..., None].astype(np.float32)


class HostBridge(Bridge):
    on_host = True


def test_commands_on_the_host_are_numpys():
    """A state in float64 stays so: an array of JAX would make it float32."""
    command = HostBridge(BridgeConfig(), WorldsConfig()).command(np.full((3, 1), 0.5, np.float32))
    assert isinstance(command, np.ndarray)
    assert (np.zeros((3, 1)) + command).dtype == np.float64


def trainer_of(task: type[Task], **ppo) -> Trainer:
    stated = {
        "network": {"hidden": [4]},
        "ppo": SMALL | {"candidates": 40} | ppo,
        "held_out": {"starts": 4, "arenas": 1, "steps": 3},
        "terrain": {"arenas": 1},
        "env": {"task": "bridge"},
    }
    config = RunConfig[BridgeConfig, Task.Worlds].model_validate(stated)
    return Trainer(config, task(config.env, config.terrain))


@pytest.fixture(scope="module", params=[Bridge, HostBridge], ids=["device", "host"])
def practised(request):
    """A trainer with half of its starts by failures, its state after eight updates, metrics."""
    trainer = trainer_of(request.param, failure_starts=0.5)
    state, rows = trainer.fresh_state(), []
    for _ in range(8):
        with jax.numpy_rank_promotion("allow"):  # Brax's normaliser relies on it
            state, metrics = trainer.train_step(trainer.world, state)
        rows.append({name: float(value) for name, value in metrics.items()})
    return trainer, state, rows


def test_the_group_that_fails_gets_a_larger_share_of_the_starts(practised):
    _, state, rows = practised
    # Evenly, a quarter; with rates of nearly 1 and 0 half of the starts are nearly all bridges.
    later = np.mean([row["walk/starts/bridge"] for row in rows[3:]])
    assert 0.5 < later < 0.75
    for row in rows:
        assert row["walk/starts/road"] + row["walk/starts/bridge"] == pytest.approx(1.0)
    assert rows[-1]["walk/failure_rate/bridge"] > 0.9
    assert rows[-1]["walk/failure_rate/road"] < 0.1
    np.testing.assert_array_equal(state.failures.group, np.asarray(state.episode["bridge"]))


def test_what_is_counted_is_in_the_checkpoint_and_resuming_goes_on_bitwise(
    practised, tmp_path, brax_ranks
):
    trainer, _, _ = practised
    first = trainer.fresh_state()
    state, _ = trainer.train_step(trainer.world, first)
    checkpoints = Checkpoints(tmp_path)
    checkpoints.save(1, trainer.gather(state), {})
    _, again, _ = checkpoints.latest(trainer.shapes)
    for _ in range(2):
        state, metrics = trainer.train_step(trainer.world, state)
        again, repeated = trainer.train_step(trainer.world, trainer.place(again))
        assert jax.tree.map(float, metrics) == jax.tree.map(float, repeated)
    for one, other in zip(
        jax.tree.leaves(state.failures), jax.tree.leaves(again.failures), strict=True
    ):
        np.testing.assert_array_equal(one, other)


def test_off_it_is_no_part_of_the_state_and_checkpoints_are_as_before(
    practised, tmp_path, brax_ranks
):
    trainer, _, _ = practised
    off = trainer_of(type(trainer.task))
    state = off.fresh_state()
    assert state.failures is None
    assert off.config.ppo.failure_starts == 0.0
    Checkpoints(tmp_path / "off").save(0, state, {})
    Checkpoints(tmp_path / "off").latest(off.shapes)
    with pytest.raises(InputError, match="failures"):
        Checkpoints(tmp_path / "off").latest(trainer.shapes)


@pytest.fixture(scope="module")
def candidates():
    """Forty candidates of three groups, some invalid, and how often each group fails."""
    generator = np.random.default_rng(0)
    valid, group = generator.uniform(size=40) < 0.7, generator.integers(0, 3, 40)
    group[~valid] = 2  # what fails most
    group[np.flatnonzero(valid)[0]] = 2
    return Starts({"number": np.arange(40)}, valid, group), np.float32([0.05, 0.3, 0.9])


@pytest.mark.parametrize("share", [0.25, 1.0])
def test_each_candidate_is_drawn_as_often_as_said(candidates, share):
    starts, rate = candidates
    count = 40_000
    failing = np.where(starts.valid, rate[starts.group], 0.0)
    expected = (1 - share) * starts.valid / starts.valid.sum() + share * failing / failing.sum()
    pool = jax.jit(pool_of)(starts)
    draw = jax.jit(draw_failing_picks, static_argnums=2)
    on_device = draw(pool, jax.random.key(1), (count,), rate, share)
    host = HostPool.of(starts)
    picks = host.draw_failing_picks(np.random.default_rng(1), (count,), rate, share)
    on_host = host.state["number"][picks]
    for drawn in (np.asarray(on_device), on_host):
        assert starts.valid[drawn].all()
        found = np.bincount(drawn, minlength=40) / count
        assert np.abs(found - expected).max() < 5 * np.sqrt(expected.max() / count)


def test_episodes_are_counted_alike_on_device_and_host():
    generator = np.random.default_rng(2)
    began = generator.integers(0, 3, (5, 7)).astype(np.int32)
    over = generator.uniform(size=(5, 7)) < 0.5
    failed = over & (generator.uniform(size=(5, 7)) < 0.5)
    before = Failures(began[0], np.float32([4, 0, 1]), np.float32([2, 0, 1]))
    on_device = jax.jit(counted)(before, began, over, failed, began[-1])
    on_host = counted_on_host(before, began, over, failed, began[-1])
    slow = [4 * 0.9, 0.0, 0.9], [2 * 0.9, 0.0, 0.9]
    for row in range(5):
        for robot in range(7):
            slow[0][began[row, robot]] += over[row, robot]
            slow[1][began[row, robot]] += failed[row, robot]
    for found in (on_device, on_host):
        np.testing.assert_allclose(found.ended, slow[0], rtol=1e-6)
        np.testing.assert_allclose(found.failed, slow[1], rtol=1e-6)
        np.testing.assert_allclose(
            found.rate, (np.array(slow[1]) + 1) / (np.array(slow[0]) + 2), rtol=1e-6
        )
