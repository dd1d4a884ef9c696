"""`jaxleas label`, killed again and again: nothing lost, nothing twice, the same verdicts."""

import os
import random
import signal
import subprocess
import sys
import time

import pytest

from jaxleas.files import FolderLock
from jaxleas.guide.files import write_guide_paths
from jaxleas.labels import read_verdicts
from jaxleas.labels.commands import label
from jaxleas.terrain.scene_file import write_scene
from jaxleas.types import InputError
from tests.contacts.sampling.worlds import hole, straight
from tests.training.runs import ROOT, environment

# Files, each a shard: four kills come after 12 at most, and a fast machine does some more.
PARTS = 36


@pytest.fixture
def work(tmp_path):
    for part in range(PARTS):
        paths = [straight(0.5 + 0.1 * n, y=0.01 * part) for n in range(4)]
        write_guide_paths(tmp_path / f"walks_{part:02d}.npz", paths, ["reached"] * 4)
    write_scene(tmp_path / "hole.json", hole())
    return tmp_path


def command_of(folder, out):
    guides = sorted(map(str, folder.glob("walks_*.npz")))
    words = [*guides, "--scene", str(folder / "hole.json"), "--out", str(out)]
    return [sys.executable, "-m", "jaxleas.cli", "label", *words, "--planner", "sl1m"]


def verdicts_of(out):
    return [
        (provenance["guides"]["file"], verdict.path, verdict.success, verdict.last_index)
        for provenance, verdict in read_verdicts(out)
    ]


@pytest.mark.slow
def test_killed_in_mid_run_nothing_is_lost_and_nothing_done_twice(work):
    draw, out = random.Random(0), work / "killed"
    written = {}
    for _ in range(4):
        process = subprocess.Popen(
            [*command_of(work, out), "--processes", "2"],
            cwd=ROOT,
            env=environment(1),
            stdout=subprocess.DEVNULL,
            start_new_session=True,
        )
        enough = len(written) + draw.randint(1, 3)
        while len(list(out.rglob("verdicts_*.json"))) < enough and process.poll() is None:
            time.sleep(0.002)
        time.sleep(draw.uniform(0.0, 0.02))
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        now = {path: path.stat().st_mtime_ns for path in out.rglob("verdicts_*.json")}
        assert written.items() <= now.items()  # what was there was not judged again
        written = now
    guides = sorted(work.glob("walks_*.npz"))
    for folder in (out, work / "whole"):
        label(guides, scene=work / "hole.json", out=folder, planner="sl1m", processes=1)
    assert 0 < len(written) < PARTS
    assert all(path.stat().st_mtime_ns == then for path, then in written.items())
    assert verdicts_of(out) == verdicts_of(work / "whole")
    assert len(verdicts_of(out)) == 4 * PARTS


def test_two_do_not_label_into_one_folder(work):
    guides = sorted(work.glob("walks_*.npz"))[:1]
    with (
        FolderLock(work, "the label folder", "give another --out"),
        pytest.raises(InputError, match=r"is in use by process \d+; .* give another --out"),
    ):
        label(guides, scene=work / "hole.json", out=work, planner="sl1m", processes=1)
