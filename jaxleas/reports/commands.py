"""The commands `jaxleas evaluate` and `jaxleas report`."""

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from jaxleas.configuration import Allow
from jaxleas.contacts import PlannerName
from jaxleas.evaluation import (
    Candidate,
    Contenders,
    Evaluation,
    MapCells,
    Planning,
    Reporter,
    Suite,
    compare,
    examine,
    keep_evaluation,
    load_candidate,
    load_refusal,
    make_contenders,
    make_report_basis,
    make_suite,
    parse_policies,
    read_evaluation,
    run_evaluations,
    side_by_side_file,
    suited,
    write_evaluation,
)
from jaxleas.guide import ResultName
from jaxleas.labels import settings_of, with_parameters
from jaxleas.reports.planner_options import planner_names, planner_settings, words
from jaxleas.reports.scene_pictures import draw_side_by_side
from jaxleas.reports.side_by_side import side_by_side as table_of
from jaxleas.reports.table import plain_table
from jaxleas.terrain import NoiseConfig, noise_of
from jaxleas.types import InputError


def evaluate(
    run: Path,
    suite: str = "transitions",
    starts: int | None = None,
    json: Path | None = None,
    baseline: bool = True,
    seed: int = 0,
    held_out: bool = False,
    planners: Sequence[PlannerName] | None = None,
    methods: Sequence[ResultName] | None = None,
    policies: Sequence[str] | None = None,
    time_limit: float | None = None,
    max_combinations: int | None = None,
    slack_weights: Literal["uniform", "guide"] | None = None,
    parameters: Sequence[str] | None = None,
    processes: int | None = None,
    pictures: Path | None = None,
    surrogate: Path | None = None,
    threshold: float | None = None,
    noise: Sequence[str] | None = None,
    allow: Allow = (),
) -> Evaluation:
    """Judge a policy on terrains it was never trained on, and print the table.

    With --planners (and for the suite thesis always) methods stand side by side, judged by exact
    contact planners; the result file grows cell by cell, and the same command resumes
    where it was interrupted.

    Args:
        run: run folder, policy.npz, .onnx file, or pretrained:NAME.
        suite: transitions, hole, wall, circuit, dead_end, evaluation_terrain, footsteps, tables
            or thesis.
        starts: number of starts per cell; by default 1000 for transitions, 200 or 100 for the
            others.
        json: file to write the result to as well; a run folder keeps the result with the most
            starts in RUN/evaluation/.
        baseline: judge the baselines, RB-Lin and RB-Kino, as well.
        seed: seed of scenes and starts; training never sees any of them.
        held_out: judge on the terrain for choosing and tuning, instead of that for evaluation.
        planners: exact planners that judge, or none; for the suite thesis those of the thesis.
        methods: methods that stand side by side, the further policies among them; by default all.
        policies: further policies, each as name=path.
        time_limit: time limit of mip, sl1m and astar for one guide path [s]; a path not decided by
            then counts as not planned.
        max_combinations: most combinations that SL1M tries for what its relaxation leaves
            undecided; 0: SL1M without heuristics.
        slack_weights: weights of SL1M's slacks: uniform or guide.
        parameters: any settings of the planners, such as model=feet; each planner takes those that
            it has.
        processes: number of processes that plan contacts at the same time; all cores by default.
        pictures: folder for pictures of the guide paths.
        surrogate: file of a planner's surrogate; guide paths that it foresees to fail are refused:
            they end early, as stopped. The result is kept in --json only.
        threshold: probability of success, as the surrogate foresees it, below which a walk is
            refused: the risk dial.
        noise: what is wrong with the maps that policy and guard see, such as white=0.02
            missing=0.02: the settings of terrain.noise; walks are judged on the true terrain. The
            result is kept in --json only.
        allow: conditions of your own under which the policy was trained, so that they end walks as
            well; by default only R* and C do. The result is kept in --json only.

    Raises:
        InputError: there is no such policy, suite, planner or method, or a number is out of range.
    """
    chosen = make_suite(suite, starts, seed, held_out)  # report mistakes before loading
    side_by_side = any((suite == "thesis", planners, methods, policies, pictures))
    names = planner_names(suite, planners)
    given = {
        "time_limit": time_limit,
        "max_combinations": max_combinations,
        "weights": slack_weights,
    }
    named = settings_of(parameters or ())
    settings = planner_settings(names, with_parameters(given, named), named)
    further = parse_policies(words(policies) or ())
    if json is not None and json.exists():
        _require_evaluation(json)
    if pictures is not None and pictures.exists() and not pictures.is_dir():
        raise InputError(f"--pictures {pictures} is a file; give a folder, new or there already")
    if processes is not None and processes < 1:
        raise InputError(f"--processes is {processes}; give 1 or more")
    sensed = noise_of(noise)
    if sensed is not None and side_by_side:
        raise InputError(
            "--noise judges one policy by the conditions: leave out --planners, --methods,"
            " --policies and --pictures, and take another suite than thesis"
        )
    refusal = load_refusal(surrogate, threshold, names)
    candidate = load_candidate(run, refusal, allow)
    if candidate.note:
        print(candidate.note)
    chosen = suited(chosen, candidate.env.robot)
    kept = candidate.terms.are_standard and sensed is None
    folder = Path(run) if Path(run).is_dir() and kept else None
    if not side_by_side:
        return _evaluate_alone(candidate, chosen, baseline, sensed, _Kept(folder, json))
    robot = candidate.env.config.robot
    for note in dict.fromkeys(filter(None, (each.note_for(robot) for each in settings.values()))):
        print(note)
    contenders = make_contenders(candidate, further, words(methods))
    if json is None and folder is not None:
        json = side_by_side_file(folder, chosen)
    planning = Planning(names, settings, processes or os.cpu_count() or 1)
    evaluation = _evaluate_side_by_side(candidate, contenders, chosen, planning, json)
    if pictures is not None:
        with Reporter() as reporter:
            drawn = draw_side_by_side(
                candidate.env, contenders.methods, chosen, names[:1], pictures, reporter.say
            )
        print(f"drawn: {len(drawn)} pictures in {pictures}")
    return evaluation


@dataclass(frozen=True)
class _Kept:
    """Where an evaluation is kept: a run folder, a file of its own, both or neither."""

    folder: Path | None
    json: Path | None


def _cells_in_words(cells: MapCells) -> str:
    return (
        f"of the ground's cells in the maps {100 * cells.missing:.1f} % were missing:"
        f" {100 * cells.filled:.1f} % were filled, {100 * cells.unknown:.1f} % stayed unknown"
    )


def _evaluate_alone(
    candidate: Candidate,
    suite: Suite,
    baseline: bool,
    noise: NoiseConfig | None,
    kept: "_Kept",
) -> Evaluation:
    """Judge a policy by the conditions; print the table, and keep it where that is wanted."""
    with Reporter() as reporter:
        evaluation = examine(
            candidate, suite, baseline=baseline, progress=reporter.say, noise=noise
        )
    print(plain_table(evaluation))
    if evaluation.map_cells is not None:
        print(_cells_in_words(evaluation.map_cells))
    if kept.folder is not None:
        keep_evaluation(kept.folder, candidate, evaluation)
    if kept.json is not None:
        write_evaluation(kept.json, evaluation)
        print(f"written: {kept.json}")
    return evaluation


def _evaluate_side_by_side(
    candidate: Candidate,
    contenders: Contenders,
    suite: Suite,
    planning: Planning,
    file: Path | None,
) -> Evaluation:
    """Judge methods by exact planners, cell by cell into a file; print the table."""
    with Reporter() as reporter:
        evaluation = compare(candidate, contenders, suite, planning, file=file, say=reporter.say)
    print(table_of(evaluation))
    if file is not None:
        print(f"written: {file}")
    return evaluation


def _require_evaluation(file: Path) -> None:
    """Refuse to overwrite a file that is not an evaluation: a scene named by mistake, say."""
    try:
        read_evaluation(file)
    except InputError as error:
        raise InputError(
            f"--json {file} is there and holds no evaluation ({error}); remove it, or give another"
        ) from error


def report(run: Path, out: Path | None = None) -> Path:
    """Write a run's report as one self-contained HTML file.

    Suites that the run was not yet judged on are judged first.

    Args:
        run: a run folder.
        out: file to write; by default RUN/report.html.

    Raises:
        InputError: the path is not a run folder, or holds no policy yet.
    """
    from jaxleas.reports.run_report import write_report

    run = Path(run)
    if not run.is_dir():
        raise InputError(f"{run} is not a run folder: a report needs one, as training writes it")
    candidate = load_candidate(run)
    with Reporter() as reporter:
        basis = make_report_basis(candidate.env.robot)
        evaluations = run_evaluations(candidate, run, basis, reporter.say)
        path = write_report(run, candidate, evaluations, basis, out, reporter.say)
    print(f"written: {path}")
    return path
