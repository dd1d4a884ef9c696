"""Evaluations, figures, and what a distillation leaves behind."""

import json
from functools import partial
from pathlib import Path

from tests.robustness.hostile_files import mutations as m
from tests.robustness.hostile_files.kinds import Kind, kind_of

_PART = {
    **{"count": 30, "failed": 3, "balanced_accuracy": 0.8, "area_under_curve": 0.9},
    **{"calibration_error": 0.01, "log_loss": 0.2, "log_loss_of_the_share": 0.3},
    "confusion": {
        **{"threshold": 0.1, "failed_foreseen": 2, "failed_unforeseen": 1},
        **{"passed_foreseen": 20, "passed_unforeseen": 7},
    },
    "curve": [[0.01, 0.02, 15.0], [0.3, 0.2, 15.0]],
}


def judgement_kinds(folder: Path) -> list[Kind]:
    from jaxleas.configuration.loading import load_config
    from jaxleas.distillation.config import DistillationConfig
    from jaxleas.distillation.folder import read_begun_with, read_done
    from jaxleas.distillation.judging import read_judged
    from jaxleas.distillation.rounds_file import read_rounds
    from jaxleas.evaluation.figure_file import Course, Figures, read_figures, write_figures
    from jaxleas.evaluation.result_file import (
        CellResult,
        Evaluation,
        read_evaluation,
        write_evaluation,
    )

    shares = {"reached": 0.9, "invalid": 0.1, "stopped": 0.0, "low": 0.6, "high": 0.98}
    cell = CellResult.model_validate(
        {"name": "bridge", "yaw": 0.0, "method": "leas_p1", "starts": 10} | shares
    )
    evaluation = Evaluation(
        suite="transitions", policy="x", robot="talos", seed=0, created="2026", cells=(cell,)
    )
    write_evaluation(folder / "evaluation.json", evaluation)
    figures = Figures(
        created="2026",
        planner="mip",
        settings={"keep_every": 5},
        policies={},
        seed=0,
        held_out=True,
        courses=(Course(method="leas_p1", reached=True, planned=True, x=(0.0,), step=(0.2,)),),
    )
    write_figures(folder / "figures.json", figures)
    row = {"round": 0, "success": 0.5, "cells": {"bridge 0°": 0.5}, "labels": 0, "seconds": {}}
    rows = [row | {"surrogate": None}, row | {"surrogate": {"stretch": _PART, "guide": _PART}}]
    plain = {
        "judged": {"version": 1, "cells": [cell.model_dump(mode="json")]},
        "rounds": {"version": 1, "rounds": rows},
        "begun_with": {"version": 1, "run": "runs/leas_p1"},
        "done": {"guides": 3, "seconds": 4.5},
    }
    for name, content in plain.items():
        (folder / f"{name}.json").write_text(json.dumps(content))
    (folder / "distil.yaml").write_text("planner: mip\nparameters: {keep_every: 3}\nrounds: 2\n")
    config = partial(load_config, DistillationConfig)

    def done(path: Path) -> None:
        read_done(path, "guides", "seconds")

    return [
        kind_of("evaluation", folder / "evaluation.json", read_evaluation, m.mutate_json),
        kind_of("figures", folder / "figures.json", read_figures, m.mutate_json),
        kind_of("distillation", folder / "distil.yaml", config, m.mutate_yaml),
        kind_of("judged round", folder / "judged.json", read_judged, m.mutate_json),
        kind_of("rounds", folder / "rounds.json", read_rounds, m.mutate_json),
        kind_of("begun with", folder / "begun_with.json", read_begun_with, m.mutate_json),
        kind_of("stage done", folder / "done.json", done, m.mutate_json),
    ]
