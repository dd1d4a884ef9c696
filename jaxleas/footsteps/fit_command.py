"""The function behind `jaxleas gait fit`."""

import sys
from collections.abc import Sequence
from dataclasses import asdict, replace
from pathlib import Path

from jaxleas.files import digest_of, write_json, write_text
from jaxleas.footsteps.features import Predictors
from jaxleas.footsteps.fit_pictures import draw_displacements
from jaxleas.footsteps.fit_report import report_fit
from jaxleas.footsteps.fitting import FitSettings, Fitted, fit_motion_models
from jaxleas.footsteps.judging import ALL
from jaxleas.footsteps.model_file import write_motion_model
from jaxleas.footsteps.record_file import read_footsteps
from jaxleas.footsteps.records import FootstepRecords, join_footsteps
from jaxleas.runs import collect_provenance
from jaxleas.types import MOVEMENTS, InputError

MODEL, REPORT, SCORES = "model.npz", "report.md", "scores.json"


def fit(
    footsteps: Sequence[Path],
    *,
    out: Path,
    movements: Sequence[str] = MOVEMENTS,
    predictors: Predictors = "C4",
    network: bool = True,
    seed: int = 0,
) -> None:
    """Fit motion models of a controller to its footsteps, and report how well they predict.

    Args:
        footsteps: files of footsteps of one controller.
        out: folder for the models (model.npz), the report (report.md), its numbers (scores.json)
            and pictures of mean displacements.
        movements: movements that the models must answer for.
        predictors: inputs of the models that are kept, C1 to C4; all four are reported.
        network: also fit a small network for comparison, which takes a minute.
        seed: seed of the folds and of the network.
    """
    records = _read_all(footsteps)
    settings = FitSettings(tuple(movements), predictors, seed, network)
    fitted = fit_motion_models(records, settings)
    origin = {
        "footsteps": [{"file": str(each), "sha256": digest_of(each)} for each in footsteps],
        "settings": asdict(settings),
        **collect_provenance(sys.argv)[0],
    }
    out.mkdir(parents=True, exist_ok=True)
    draw_displacements(records, out)
    write_json(out / SCORES, {"version": 1, "scores": [asdict(each) for each in fitted.scores]})
    write_text(out / REPORT, report_fit(fitted, records))
    write_motion_model(out / MODEL, replace(fitted.model, provenance=origin))
    print(_in_words(fitted, len(records.footsteps)), f"written to {out}", sep="\n")


def _read_all(paths: Sequence[Path]) -> FootstepRecords:
    """Return the footsteps of several files of one controller and one definition."""
    parts = [read_footsteps(path) for path in paths]
    first = parts[0]
    for path, part in zip(paths[1:], parts[1:], strict=True):
        first.controller.require_same(part.controller, str(path), str(paths[0]))
        if part.definition != first.definition:
            raise InputError(
                f"{path} holds footsteps by the definition '{part.definition}', {paths[0]} by"
                f" '{first.definition}': fit them apart"
            )
    reasons = {reason: 0 for part in parts for reason in part.rejected}
    rejected = {reason: sum(part.rejected.get(reason, 0) for part in parts) for reason in reasons}
    joined = join_footsteps([part.footsteps for part in parts])
    return replace(first, footsteps=joined, rejected=rejected)


def _in_words(fitted: Fitted, count: int) -> str:
    """Return the result of a fit in a sentence."""
    model = fitted.model
    kept = [
        each
        for each in fitted.scores
        if (each.model, each.predictors, each.split) == ("linear", model.predictors, "run")
        and each.feet in ("", model.feet)
        and each.movement == ALL
    ]
    worst = min(kept, key=lambda each: 100.0 if each.r2 is None else each.r2)
    share = "" if worst.r2 is None else f" with R2 {worst.r2:.2f} %"
    return (
        f"{len(kept)} models of {model.controller.name} on {model.controller.robot} from {count}"
        f" footsteps; on unseen runs the weakest is {worst.target} while {worst.pair} swings"
        f"{share}; 95 % of landings are within {100 * model.errors.landing['0.95']:.1f} cm of their"
        " prediction"
    )
