"""Queries, guide paths, verdicts."""

import json
from pathlib import Path

import numpy as np

from tests.robustness.hostile_files import binary_mutations as b
from tests.robustness.hostile_files import mutations as m
from tests.robustness.hostile_files.kinds import Kind, kind_of


def guide_kinds(folder: Path) -> list[Kind]:
    from jaxleas.contacts.guide_file import read_guide_path
    from jaxleas.guide.failures import Failure
    from jaxleas.guide.files import read_queries, write_guide_paths
    from jaxleas.labels.label import make_shards
    from jaxleas.labels.oracle import Oracle
    from jaxleas.labels.shards import read_verdicts, write_shard
    from jaxleas.surrogates.label_files import read_labels
    from jaxleas.types import GuidePath, Verdict
    from jaxleas.viewer.clips import read_guide_clips

    query = {"position": [0.5, 0.5, 0.95], "yaw": 0.0, "velocity": [0, 0, 0], "goal": [2.5, 0.5]}
    (folder / "queries.json").write_text(json.dumps([query, query]))
    rows = 30
    path = GuidePath(
        time=0.2 * np.arange(rows),
        position=np.column_stack([np.linspace(0.3, 1.5, rows), np.full((rows, 2), [0.5, 0.95])]),
        yaw=np.zeros(rows),
        velocity=np.zeros((rows, 3)),
        valid=np.ones(rows, bool),
    )
    failures = [None, Failure("collision", -0.1)]
    write_guide_paths(
        folder / "guides.npz",
        [path, path],
        ["reached", "invalid"],
        robot="talos",
        failures=failures,
    )
    scene, guides = folder / "scene.json", folder / "guides.npz"
    (shard,) = make_shards([guides], scene, Oracle("sampling", robot="talos"), folder / "labels")
    verdict = Verdict(
        *(0, True, True, 29, 30, 1.0, 4, 0.2, 0, 10.0, 12.0, None, None, "", 0.1),
    )
    fields = verdict.__dict__
    write_shard(shard, [verdict, Verdict(**(fields | {"path": 1, "success": False}))])

    def guides_read(path: Path) -> None:
        read_guide_clips(path)
        read_guide_path(path)

    def labels_read(path: Path) -> None:
        read_verdicts(path.parent)
        read_labels([path.parent], [], 0.2)

    return [
        kind_of("queries", folder / "queries.json", read_queries, m.mutate_json),
        kind_of("guide paths", guides, guides_read, b.mutate_npz),
        kind_of("verdicts", shard.out, labels_read, m.mutate_json, scene, guides),
    ]
