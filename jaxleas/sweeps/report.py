"""A sweep's report: one self-contained HTML file."""

from collections.abc import Mapping, Sequence

from jaxleas.reports import page_template
from jaxleas.sweeps.border import Sweep
from jaxleas.sweeps.charts import importance_bars, learning_curves, parallel_coordinates
from jaxleas.sweeps.folder import SweepFolder
from jaxleas.sweeps.objectives import is_maximised, learning_curve
from jaxleas.sweeps.results import TrialResult, best_of, ranked, shown_param, shown_value

TEMPLATE = "report.html"


def report_html(
    sweep: Sweep,
    results: Sequence[TrialResult],
    importance: Mapping[str, float],
    folder: SweepFolder,
) -> str:
    """Return the report: table, parallel coordinates, importance, learning curves.

    Args:
        sweep: sweep that was conducted.
        results: results of its trials.
        importance: importance of the searched fields for the first objective, as shares.
        folder: folder of the sweep, with the run folders of the trials that ran here.
    """
    config = sweep.config
    front = best_of(results, config.objectives)
    total = sweep.base.ppo.updates * sweep.base.ppo.batch
    curves = {
        f"trial {each.number}, seed {seed}": learning_curve(folder.run(each.number, seed))
        for each in results
        for seed in config.seeds
    }
    best = [f"trial {each.number}, seed {seed}" for each in front for seed in config.seeds]
    first = config.objectives[0]
    return page_template("jaxleas.sweeps", TEMPLATE).render(
        name=sweep.name,
        base=config.config,
        counts={s: sum(r.state == s for r in results) for s in ("done", "pruned", "failed")},
        seeds=config.seeds,
        objectives=[each.name for each in config.objectives],
        fields=list(config.space),
        rows=[
            {
                "number": each.number,
                "best": each in front,
                "state": each.state,
                "values": [
                    shown_value(one, each.values.get(one.name), float(total))
                    for one in config.objectives
                ],
                "params": [shown_param(each.params.get(name)) for name in config.space],
                "reason": each.reason,
            }
            for each in ranked(results, config.objectives)
        ],
        coordinates=[
            (each.name, parallel_coordinates(results, config.space, each.name, is_maximised(each)))
            for each in config.objectives
        ],
        importance=importance_bars(importance) if importance else "",
        measure=first.name,
        curves=learning_curves({name: c for name, c in curves.items() if c}, best, total),
    )
