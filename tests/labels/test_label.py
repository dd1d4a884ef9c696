import json

import numpy as np
import pytest

from jaxleas.contacts.sampling import SamplingSettings, plan_contacts
from jaxleas.guide.files import write_guide_paths
from jaxleas.labels import (
    Here,
    MipSettings,
    Oracle,
    ProcessWorkers,
    Sl1mSettings,
    judge_shard,
    label_shards,
    make_shards,
    read_verdicts,
)
from jaxleas.labels.commands import label
from jaxleas.robots import load_robot
from jaxleas.terrain.scene_file import write_scene
from jaxleas.types import InputError
from tests.contacts.sampling.worlds import hole, straight

TALOS = load_robot("talos")

SETTINGS = SamplingSettings()


@pytest.fixture
def work(tmp_path):
    paths = [straight(0.4 + 0.5 * n, y=0.1 * n) for n in range(5)]
    write_guide_paths(tmp_path / "walks.npz", paths, ["reached"] * 5)
    write_scene(tmp_path / "hole.json", hole())
    return tmp_path, paths


def shards_of(folder, settings=SETTINGS):
    return make_shards(
        [folder / "walks.npz"],
        folder / "hole.json",
        Oracle("sampling", settings, robot="talos"),
        folder / "out",
        2,
    )


def test_verdicts_are_those_of_the_planner_with_provenance(work):
    folder, paths = work
    counted = []
    assert label_shards(shards_of(folder), Here(), counted.append) == (5, 0)
    assert sum(counted) == 5
    found = read_verdicts(folder / "out")
    assert [verdict.path for _, verdict in found] == list(range(5))
    for path, (provenance, verdict) in zip(paths, found, strict=True):
        plan = plan_contacts(hole(), path, robot=TALOS)
        assert verdict.success == plan.success
        assert verdict.last_index == plan.last_index
        np.testing.assert_allclose(verdict.mean_robustness, plan.robustness.mean(), rtol=1e-3)
        assert provenance["planner"] == "sampling"
        assert provenance["parameters"]["samples"] == 25_000
        assert provenance["seed"] == 0
        assert len(provenance["scene"]["sha256"]) == 64
    assert {verdict.success for _, verdict in found} == {True, False}


def test_only_what_is_missing_is_judged_again(work):
    folder, _ = work
    label_shards(shards_of(folder), Here(), lambda count: None)
    files = sorted((folder / "out").rglob("*.json"))
    assert len(files) == 3
    times = [path.stat().st_mtime_ns for path in files]
    files[1].unlink()
    assert label_shards(shards_of(folder), Here(), lambda count: None) == (2, 3)
    assert files[1].exists()
    assert [files[0].stat().st_mtime_ns, files[2].stat().st_mtime_ns] == [times[0], times[2]]


def test_verdicts_of_other_settings_are_not_mixed_in(work):
    folder, _ = work
    label_shards(shards_of(folder), Here(), lambda count: None)
    with pytest.raises(InputError, match="with other parameters and seed"):
        label_shards(shards_of(folder, SamplingSettings(seed=1)), Here(), lambda count: None)


@pytest.mark.slow
def test_two_processes_say_the_same_as_one(work):
    folder, _ = work
    label_shards(shards_of(folder), Here(), lambda count: None)
    alone = [verdict for _, verdict in read_verdicts(folder / "out")]
    for path in (folder / "out").rglob("*.json"):
        path.unlink()
    workers = ProcessWorkers(2)
    try:
        assert label_shards(shards_of(folder), workers, lambda count: None) == (5, 0)
    finally:
        workers.close()
    together = [verdict for _, verdict in read_verdicts(folder / "out")]
    for one, other in zip(alone, together, strict=True):
        assert (one.path, one.success, one.last_index) == (
            other.path,
            other.success,
            other.last_index,
        )


def test_the_command_says_how_many_succeed(work, capsys):
    folder, _ = work
    label([folder / "walks.npz"], scene=folder / "hole.json", out=folder / "out", processes=1)
    assert "of 5 guide paths succeed" in capsys.readouterr().out
    label([folder / "walks.npz"], scene=folder / "hole.json", out=folder / "out", processes=1)
    assert "0 judged now" in capsys.readouterr().out


def test_a_shard_written_by_a_worker_that_died_is_not_judged_twice(work):
    folder, _ = work
    shard = shards_of(folder)[0]
    judge_shard(shard)
    written = shard.out.stat().st_mtime_ns
    assert judge_shard(shard) == 2
    assert shard.out.stat().st_mtime_ns == written


@pytest.mark.parametrize("settings", [MipSettings(keep_every=20), Sl1mSettings(max_combinations=9)])
def test_every_planner_leaves_its_parameters_in_the_file(work, settings):
    folder, _ = work
    name = "sl1m" if isinstance(settings, Sl1mSettings) else "mip"
    shards = make_shards(
        [folder / "walks.npz"],
        folder / "hole.json",
        Oracle(name, settings, robot="talos"),
        folder / "out",
    )
    assert label_shards(shards, Here(), lambda count: None) == (5, 0)
    for provenance, verdict in read_verdicts(folder / "out"):
        assert provenance["planner"] == name
        assert type(settings)(**provenance["parameters"]) == settings.for_robot("talos")
        assert provenance["seed"] is None
        assert verdict.decided


def test_bad_input_is_one_sentence(work):
    folder, _ = work
    with pytest.raises(InputError, match="no planner 'magic'"):
        make_shards(
            [folder / "walks.npz"],
            folder / "hole.json",
            Oracle("magic", SETTINGS, robot="talos"),
            folder / "out",
        )
    with pytest.raises(InputError, match="two guide path files are called walks"):
        make_shards(
            [folder / "walks.npz"] * 2,
            folder / "hole.json",
            Oracle("sampling", SETTINGS, robot="talos"),
            folder / "out",
        )
    with pytest.raises(InputError, match="takes MipSettings, not SamplingSettings"):
        make_shards(
            [folder / "walks.npz"],
            folder / "hole.json",
            Oracle("mip", SETTINGS, robot="talos"),
            folder / "out",
        )
    with pytest.raises(InputError, match="--samples is for the planner sampling, not for mip"):
        label(
            [folder / "walks.npz"],
            scene=folder / "hole.json",
            out=folder / "out",
            planner="mip",
            samples=7,
        )
    with pytest.raises(InputError, match="--keep-every 0: input should be greater than 0"):
        label([folder / "walks.npz"], scene=folder / "hole.json", out=folder / "o", keep_every=0)
    assert not (folder / "out").exists()
    with pytest.raises(InputError, match="--processes is 0"):
        label([folder / "walks.npz"], scene=folder / "hole.json", out=folder / "out", processes=0)
    with pytest.raises(InputError, match="holds no verdicts"):
        read_verdicts(folder / "nowhere")
    path = folder / "out" / "verdicts_000000.json"
    path.parent.mkdir()
    path.write_text(json.dumps({"version": 7}))
    with pytest.raises(InputError, match="no verdict file"):
        read_verdicts(folder / "out")
