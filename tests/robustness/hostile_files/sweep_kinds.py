"""Sweeps, populations, and what their folders hold."""

from dataclasses import asdict
from pathlib import Path

import yaml

from tests.robustness.hostile_files import mutations as m
from tests.robustness.hostile_files.kinds import Kind, kind_of

SEARCH = {
    "config": "base.yaml",
    "set": {"ppo.clip": 0.2},
    "space": {
        "ppo.learning_rate": {"low": 1e-4, "high": 1e-2, "log": True},
        "ppo.mirror": {"choices": [True, False]},
        "ppo.epochs": {"low": 1, "high": 4, "only_when": {"ppo.mirror": True}},
    },
    "objectives": [{"measure": "steps_to_success", "success": 0.9}],
    "trials": 3,
}
VARIED = {"config": "base.yaml", "seeds": [0, 1], "vary": {"ppo.discount": {"low": 0.9, "high": 1}}}


def sweep_kinds(folder: Path) -> list[Kind]:
    from jaxleas.files import write_json
    from jaxleas.sweeps.border import open_sweep
    from jaxleas.sweeps.evolution import Succession
    from jaxleas.sweeps.folder import open_folder
    from jaxleas.sweeps.history import History, read_history
    from jaxleas.sweeps.job_files import Outcome, read_job, read_outcome, write_job
    from jaxleas.sweeps.population_config import open_population
    from jaxleas.sweeps.population_folder import hold_population
    from jaxleas.sweeps.results import TrialResult, write_results
    from jaxleas.sweeps.study import Study, read_results

    (folder / "base.yaml").write_text(yaml.safe_dump({"ppo": {"steps": 1000}, "seed": 3}))
    (folder / "sweep.yaml").write_text(yaml.safe_dump(SEARCH, sort_keys=False))
    (folder / "population.yaml").write_text(yaml.safe_dump(VARIED))
    sweep, members = open_sweep(folder / "sweep.yaml"), open_population(folder / "population.yaml")
    out = folder / "sweep"
    opened = open_folder(out, sweep)
    study = Study(sweep, opened, None)
    trial = study.ask()
    result = TrialResult(0, "done", study.draw(trial), {"steps_to_90%": 5e3}, {"0": {"a": 1.0}})
    study.tell(trial, result)
    study.ask()
    opened.close()
    write_results(out, [result], sweep)
    with hold_population(folder / "members", members):
        pass
    History(folder / "history.jsonl", 0).append(10, [0.5, 0.1], [Succession(0, 0, {"x": 1.0})])
    write_job(folder / "job.json", [folder / "run"], ["{}"], [{"measure": "held_out"}])
    write_json(folder / "seed_0.json", asdict(Outcome("done", {"held_out": 0.9})))

    def go_on(path: Path) -> None:
        open_folder(path.parent, sweep).close()

    def remember(path: Path) -> None:
        held = open_folder(path.parent, sweep)
        try:
            found = Study(sweep, held, None)
            found.results()
            found.open_trials()
        finally:
            held.close()

    def go_on_together(path: Path) -> None:
        with hold_population(path.parent, members):
            pass

    base, rest = folder / "base.yaml", [out / "sweep.yaml", out / "base.yaml"]
    journal, record = out / "journal.log", out / "sweep.json"
    results, outcome = out / "results.json", folder / "seed_0.json"
    together = folder / "members" / "population.json"
    return [
        kind_of("sweep", folder / "sweep.yaml", open_sweep, m.mutate_yaml, base),
        kind_of("population", folder / "population.yaml", open_population, m.mutate_yaml, base),
        kind_of("sweep folder", record, go_on, m.mutate_json, *rest),
        kind_of("journal", journal, remember, m.mutate_lines, record, *rest),
        kind_of("sweep results", results, lambda p: read_results(p.parent), m.mutate_json),
        kind_of("job", folder / "job.json", read_job, m.mutate_json),
        kind_of("outcome", outcome, lambda p: read_outcome(p.with_suffix("")), m.mutate_json),
        kind_of("population folder", together, go_on_together, m.mutate_json),
        kind_of("history", folder / "history.jsonl", read_history, m.mutate_lines),
    ]
