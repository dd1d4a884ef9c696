"""Configurations, run folders, evaluations."""

import json
from functools import partial
from pathlib import Path

import yaml

from benchmarks.strangers import mutations as m
from benchmarks.strangers.kinds import Kind, kind_of


def run_kinds(folder: Path) -> list[Kind]:
    from jaxleas.distillation.config import DistillationConfig
    from jaxleas.distillation.judging import read_judged
    from jaxleas.evaluation.result_file import (
        CellResult,
        Evaluation,
        read_evaluation,
        write_evaluation,
    )
    from jaxleas.training.config import RunConfig
    from jaxleas.training.configuration import load_config, to_yaml
    from jaxleas.training.metrics import read_metrics
    from jaxleas.training.run_folder import RunFolder

    text = to_yaml(RunConfig())
    # The generator's many numbers would be most of it, and reading them most of the time.
    (folder / "config.yaml").write_text(
        text[: text.index("terrain:")] + text[text.index("network:") :]
    )
    (folder / "base.yaml").write_text(yaml.safe_dump({"ppo": {"steps": 1000}, "seed": 3}))
    (folder / "extending.yaml").write_text("extends: base.yaml\nppo: {discount: 0.9}\n")
    (folder / "distil.yaml").write_text("planner: mip\nparameters: {keep_every: 3}\nrounds: 2\n")
    row = {"step": 10, "seconds": 0.5, "walk/reward": 1.5, "held_out/reached": None}
    (folder / "metrics.jsonl").write_text("".join(json.dumps(row) + "\n" for _ in range(3)))
    (folder / "provenance.json").write_text(
        json.dumps({"format": 1, "jaxleas": "0.1", "git": None})
    )
    shares = {"reached": 0.9, "invalid": 0.1, "stopped": 0.0, "low": 0.6, "high": 0.98}
    cell = CellResult.model_validate(
        {"name": "bridge", "yaw": 0.0, "method": "leas_p1", "starts": 10} | shares
    )
    evaluation = Evaluation(
        suite="transitions", policy="x", robot="talos", seed=0, created="2026", cells=(cell,)
    )
    write_evaluation(folder / "evaluation.json", evaluation)
    (folder / "judged.json").write_text(
        json.dumps({"version": 1, "cells": [cell.model_dump(mode="json")]})
    )

    def opened(path: Path) -> None:
        RunFolder.open(path.parent, needs_checkpoint=False)

    run_config = partial(load_config, RunConfig)
    return [
        kind_of("configuration", folder / "config.yaml", run_config, m.mutate_yaml),
        kind_of(
            "extending configuration",
            folder / "extending.yaml",
            run_config,
            m.mutate_yaml,
            folder / "base.yaml",
        ),
        kind_of(
            "distillation configuration",
            folder / "distil.yaml",
            partial(load_config, DistillationConfig),
            m.mutate_yaml,
        ),
        kind_of("metrics", folder / "metrics.jsonl", read_metrics, m.mutate_lines),
        kind_of(
            "run folder", folder / "provenance.json", opened, m.mutate_json, folder / "config.yaml"
        ),
        kind_of("evaluation", folder / "evaluation.json", read_evaluation, m.mutate_json),
        kind_of("judged round", folder / "judged.json", read_judged, m.mutate_json),
    ]
