"""Configurations and run folders."""

import json
from pathlib import Path

import yaml

from tests.robustness.hostile_files import mutations as m
from tests.robustness.hostile_files.kinds import Kind, kind_of

PROVENANCE = {
    "format": 1,
    "jaxleas": "0.1",
    "git": {"revision": "0123456789abcdef", "changed": ["train.py"], "untracked": []},
    "command": ["train.py", "configs/leas_p1.yaml"],
    "created": "2026-11-26T12:00:00+00:00",
}


def run_kinds(folder: Path) -> list[Kind]:
    from jaxleas.configuration.loading import to_yaml
    from jaxleas.records import compare_runs, read_record
    from jaxleas.records.listing import as_json, table
    from jaxleas.runs.folder import RunFolder
    from jaxleas.runs.metrics import read_metrics
    from jaxleas.runs.watching.identity import lasting_identity
    from jaxleas.training.run_config import load_run_config, run_config_of
    from jaxleas.types import InputError

    config, base, metrics = (folder / n for n in ("config.yaml", "base.yaml", "metrics.jsonl"))
    text = to_yaml(run_config_of("steering")())
    # The generator's many numbers would be most of it, and reading them most of the time.
    config.write_text(text[: text.index("terrain:")] + text[text.index("network:") :])
    base.write_text(yaml.safe_dump({"ppo": {"steps": 1000}, "seed": 3}))
    (folder / "extending.yaml").write_text("extends: base.yaml\nppo: {discount: 0.9}\n")
    row = {"step": 10, "seconds": 0.5, "walk/reward": 1.5, "held_out/reached": None}
    metrics.write_text("".join(json.dumps(row) + "\n" for _ in range(3)))
    (folder / "provenance.json").write_text(json.dumps(PROVENANCE))
    (folder / "wandb.json").write_text(json.dumps({"run": "1a2b3c"}))

    def opened(path: Path) -> None:
        RunFolder.open(path.parent, needs_checkpoint=False)

    def listed(path: Path) -> None:
        record = read_record(path.parent)  # never fails: a damaged one says so
        lines = table([record], path.parent, 100)
        json.dumps(as_json(record))
        compare_runs([record, record])
        lines.encode()
        if record.state == "damaged":
            raise InputError(record.problem)

    def identity(path: Path) -> None:
        lasting_identity(path, lambda: "another")

    provenance = folder / "provenance.json"
    return [
        kind_of("configuration", config, load_run_config, m.mutate_yaml),
        kind_of("extending", folder / "extending.yaml", load_run_config, m.mutate_yaml, base),
        kind_of("metrics", metrics, read_metrics, m.mutate_lines),
        kind_of("run folder", provenance, opened, m.mutate_json, config),
        kind_of("listed run", provenance, listed, m.mutate_json, config, metrics),
        kind_of("listed configuration", config, listed, m.mutate_yaml, provenance, metrics),
        kind_of("identity", folder / "wandb.json", identity, m.mutate_json),
    ]
