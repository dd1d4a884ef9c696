"""Collections in physics: what is walked, resumed, refused, and kept when a robot falls."""

import numpy as np
import pytest

from jaxleas import cli
from jaxleas.controllers import find_controller
from jaxleas.footsteps import movement_of, read_footsteps
from jaxleas.footsteps.collecting import collect_shard, plan_shards
from jaxleas.footsteps.collection_runs import ChangingCommand, CollectionRun, plan_runs
from jaxleas.footsteps.collection_walk import CollectionSettings
from jaxleas.physics import load_body
from jaxleas.types import MOVEMENTS, InputError

BODY = load_body("anymal_b")
TROT = find_controller("trot", BODY)


def test_all_movements_and_speeds_are_planned_as_in_the_thesis() -> None:
    runs = plan_runs(MOVEMENTS)
    constant = [run for run in runs if not run.higher]
    assert len(constant) == 10 + 4 * 9
    assert len(runs) - len(constant) == 9 + 4 * 8
    assert max(run.start for run in runs if run.movement == "forward") == 1.0
    assert max(run.start for run in runs if run.movement == "left") == 0.9
    assert [run.number for run in runs] == list(range(len(runs)))
    shards = plan_shards(runs, 32, None)  # pyright: ignore[reportArgumentType]
    assert sorted(run.number for each in shards for run in each.runs) == list(range(len(runs)))
    assert all({run.movement for run in each.runs} == set(MOVEMENTS) for each in shards)
    with pytest.raises(InputError, match="movements sideways: give each at most once, of forward"):
        plan_runs(["sideways"])


def test_commands_go_up_and_back_at_times_that_no_gait_shares() -> None:
    times = 0.004 * np.arange(15_000)
    run = CollectionRun(3, "right", 0.4, (0.5, 0.9))
    commands = run.commands(TROT.identity, times, np.random.default_rng(0))
    assert not commands[:, [0, 2]].any()
    shares = -commands[:, 1] / 0.5
    changes = np.flatnonzero(np.diff(shares))
    visited = shares[changes + 1]
    np.testing.assert_allclose(visited[:6], [0.5, 0.4, 0.9, 0.4, 0.5, 0.4])
    holds = np.diff(times[changes])
    assert (holds >= 1.2 - 0.004).all()
    assert (holds <= 1.8 + 0.004).all()
    phases = times[changes] % 0.3
    assert np.histogram(phases, 3, (0.0, 0.3))[0].min() > 3


def test_changing_commands_are_single_movements_held_for_some_footsteps() -> None:
    changing = ChangingCommand(TROT.identity, np.random.default_rng(0))
    held = []
    for _ in range(2000):
        held.append(changing.now)
        changing.footstep_ended()
    commands = np.array(held)
    assert ((commands != 0.0).sum(axis=1) == 1).all()
    assert set(movement_of(commands)) == {*MOVEMENTS, "mixed"}
    np.testing.assert_allclose(commands.min(axis=0), [-0.5, -0.45, -0.9])
    np.testing.assert_allclose(commands.max(axis=0), [1.0, 0.45, 0.9])
    changes = np.flatnonzero(np.any(np.diff(commands, axis=0) != 0.0, axis=1))
    assert np.diff(changes).min() == 1
    assert 2.0 < np.diff(changes).mean() < 3.0


def test_changing_runs_change_at_contacts(tmp_path) -> None:
    (shard,) = plan_shards([CollectionRun(0, "changing", 0.0)], 1, tmp_path)
    made, fell = collect_shard(
        shard, BODY, TROT, CollectionSettings(seconds=6.0, seed=2), {}, lambda: None
    )
    steps = made["contact"].footsteps
    assert not fell
    assert len(steps) > 12
    changed = (steps.command[1:] != steps.command[:-1]).any(axis=1)
    # What is commanded in a footstep is in force from its beginning to its end.
    np.testing.assert_array_equal(steps.previous_command[1:], steps.command[:-1])
    assert 3 < changed.sum() < len(changed)


def test_a_collection_is_kept_resumed_and_not_mixed(tmp_path, capsys) -> None:
    command = ["gait", "collect", "--out", str(tmp_path / "a"), "--movements", "counter-clockwise"]
    command += ["--seconds", "1.6", "--at-once", "9", "--seed", "3"]
    cli.run(command)
    said = capsys.readouterr().out
    assert "2 shards walked now, 0 were there; 0 runs fell" in said
    file = tmp_path / "a/contact/footsteps_001.npz"
    records = read_footsteps(file)
    assert records.controller == TROT.identity
    assert records.collection["settings"]["seed"] == 3
    assert records.collection["falls"] == []
    assert set(records.footsteps.movement) == {"counter-clockwise"}
    assert len(records.footsteps) > 20
    assert set(records.footsteps.pair) == {0, 1}
    before = file.read_bytes()
    file.unlink()
    cli.run(command)
    assert "1 shards walked now, 1 were there" in capsys.readouterr().out
    again = read_footsteps(file)
    np.testing.assert_array_equal(again.footsteps.com_after, records.footsteps.com_after)
    assert len(file.read_bytes()) == pytest.approx(len(before), abs=50)
    with pytest.raises(InputError, match="collected in another way: with other noise; give anoth"):
        cli.run([*command, "--noise", "1"])
    with pytest.raises(InputError, match="is of another controller than the command"):
        cli.run([*command, "--controller", "trot_quick"])


def test_a_robot_that_falls_is_reported_and_its_steps_until_then_are_kept(tmp_path) -> None:
    run = CollectionRun(0, "forward", 1.0)
    (shard,) = plan_shards([run], 1, tmp_path)
    slippery = CollectionSettings(seconds=1.2, friction=(0.15, 0.15), noise=0.0)
    made, fell = collect_shard(shard, BODY, TROT, slippery, {}, lambda: None)
    assert [each.run for each in fell] == [0]
    assert fell[0].cause in ("tilted", "low")
    assert 0.3 < fell[0].time < 1.2
    records = read_footsteps(shard.file("contact"))
    assert records.collection["falls"][0]["time"] == fell[0].time
    assert (records.footsteps.time <= fell[0].time).all()
    assert len(made["contact"].footsteps) == len(records.footsteps)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"seconds": 0.0}, "give a positive time"),
        ({"friction": (1.0, 0.5)}, "two positive numbers in ascending order"),
        ({"trunk_mass": 1.0}, "a share below 1"),
        ({"at_once": 0}, "give at least one robot"),
    ],
)
def test_settings_that_cannot_be_are_refused(options, message) -> None:
    with pytest.raises(InputError, match=message):
        CollectionSettings(**options)
