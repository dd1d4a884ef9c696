"""Workers on Ray: none lost, none twice; where Ray is not installed, a sentence says so."""

import os
import signal
import sys
from pathlib import Path

import pytest

from jaxleas.guide.files import write_guide_paths
from jaxleas.labels import Here, Oracle, label_shards, make_shards, read_verdicts
from jaxleas.labels.commands import label
from jaxleas.terrain.scene_file import write_scene
from jaxleas.types import InputError
from jaxleas.workers.ray_workers import RayWorkers
from tests.contacts.sampling.worlds import hole, straight
from tests.labels.test_judging import complain, note_and_die_once


def test_without_ray_one_sentence_says_which_extra(monkeypatch):
    monkeypatch.setitem(sys.modules, "ray", None)
    with pytest.raises(InputError, match=r"pip install 'jaxleas\[ray\]'"):
        RayWorkers(2)


@pytest.mark.slow
def test_ray_does_the_task_of_the_dead_again_and_no_other(tmp_path):
    pytest.importorskip("ray", reason="the extra ray is not installed")
    workers = RayWorkers(2)
    try:
        tasks = [(tmp_path, number) for number in range(6)]
        answers = list(workers.run(note_and_die_once, tasks))
        assert sorted(answers) == [(n, n * n) for n in range(6)]
        assert sorted(path.name for path in tmp_path.iterdir()) == sorted(
            [*(f"{n}_0" for n in range(6)), "2_1"]
        )
        with pytest.raises(InputError, match="task 1 is bad"):
            list(workers.run(complain, [1]))
    finally:
        workers.close()


@pytest.mark.slow
def test_the_command_says_the_same_on_ray(tmp_path, capsys):
    pytest.importorskip("ray", reason="the extra ray is not installed")
    paths = [straight(0.4 + 0.5 * n) for n in range(4)]
    write_guide_paths(tmp_path / "walks.npz", paths, ["reached"] * 4)
    write_scene(tmp_path / "hole.json", hole())
    answers = []
    for workers in ("processes", "ray"):
        label(
            [tmp_path / "walks.npz"],
            scene=tmp_path / "hole.json",
            out=tmp_path / workers,
            planner="sl1m",
            processes=1,
            workers=workers,
        )
        assert "4 judged now" in capsys.readouterr().out
        answers.append(
            [(each.success, each.last_index) for _, each in read_verdicts(tmp_path / workers)]
        )
    assert answers[0] == answers[1]


@pytest.mark.slow
def test_a_worker_killed_while_it_labels_costs_nothing_but_time(tmp_path):
    """SIGKILL of the process that judges, on a real local cluster."""
    ray = pytest.importorskip("ray", reason="the extra ray is not installed")
    paths = [straight(0.4 + 0.05 * n) for n in range(24)]
    write_guide_paths(tmp_path / "walks.npz", paths, ["reached"] * len(paths))
    write_scene(tmp_path / "hole.json", hole())

    def shards(out):
        files = [tmp_path / "walks.npz"], tmp_path / "hole.json"
        return make_shards(*files, Oracle("sl1m", robot="talos"), tmp_path / out, a_shard=2)

    workers, killed = RayWorkers(2), []

    def kill_one(_):
        busy = [
            pid
            for pid in map(int, filter(str.isdigit, os.listdir("/proc")))
            if b"ray::judge_shard" in _title(pid)
        ]
        if len(killed) < 3 and busy:
            os.kill(busy[0], signal.SIGKILL)
            killed.append(busy[0])

    counted = []
    try:
        assert ray.is_initialized()
        done = label_shards(
            shards("killed"), workers, lambda count: (counted.append(count), kill_one(count))
        )
    finally:
        workers.close()
    label_shards(shards("whole"), Here(), lambda count: None)
    assert killed
    assert done == (24, 0)
    assert sum(counted) == 24
    found = [read_verdicts(tmp_path / out) for out in ("killed", "whole")]
    killed_, whole = ([(v.path, v.success, v.last_index) for _, v in each] for each in found)
    assert killed_ == whole
    assert [path for path, _, _ in killed_] == list(range(24))


def _title(pid: int) -> bytes:
    try:
        return (Path("/proc") / str(pid) / "cmdline").read_bytes()
    except OSError:
        return b""
