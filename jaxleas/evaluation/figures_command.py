"""The command `jaxleas figures`."""

import os
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from jaxleas.configuration import Allow
from jaxleas.contacts import DEFAULT_PLANNER, PlannerName, find_planner, settings_from
from jaxleas.evaluation.contenders import fingerprint_of, make_contenders, parse_policies
from jaxleas.evaluation.examination import POLICY, load_candidate
from jaxleas.evaluation.figure_file import FigureFile, Figures, read_figures, write_figures
from jaxleas.evaluation.figures import KEEP_EVERY, Questions, figure_cells, measure_figures
from jaxleas.evaluation.progress import Reporter
from jaxleas.evaluation.result_file import now
from jaxleas.evaluation.suited import suited
from jaxleas.evaluation.suites import make_suite
from jaxleas.guide import KINO, ResultName
from jaxleas.labels import planner_workers, settings_of
from jaxleas.types import InputError

METHODS = (KINO.key, POLICY)


def figures(
    run: Path,
    *,
    out: Path,
    policies: Sequence[str] | None = None,
    methods: Sequence[ResultName] | None = None,
    planner: PlannerName = DEFAULT_PLANNER,
    parameters: Sequence[str] | None = None,
    keep_every: Sequence[int] = KEEP_EVERY,
    starts: int = 30,
    course_starts: int = 10,
    seed: int = 0,
    held_out: bool = False,
    processes: int | None = None,
    allow: Allow = (),
) -> Figures:
    """Measure what the thesis's figures 4.17 and 5.6 to 5.9 show; `jaxleas report` draws them.

    Guide paths over stairs, rubble and the long course are planned for at several discretisations.
    The file grows row by row; the same command resumes where it was interrupted, and adds methods.

    Args:
        run: a LEAS-P1: run folder, policy.npz, .onnx file or pretrained:NAME.
        out: path of the figure file, .json.
        policies: further policies, each as name=path.
        methods: methods to measure, the further policies among them; by default rb_kino, leas_p1
            and the further policies.
        planner: exact planner that judges.
        parameters: any settings of the planner but keep_every, such as model=feet.
        keep_every: values of N: one configuration in every N is planned for.
        starts: number of starts on stairs and rubble.
        course_starts: number of starts on the long course, whose guide paths take longer.
        seed: seed of scenes and starts.
        held_out: use the terrain for choosing and tuning, instead of that for evaluation.
        processes: number of processes that plan contacts at the same time; all cores by default.
        allow: conditions of your own under which the policy was trained, so that they end walks as
            well.

    Raises:
        InputError: there is no such policy or method, a number is out of range, or the file belongs
            to other policies, planner settings or scenes.
    """
    if processes is not None and processes < 1:
        raise InputError(f"--processes is {processes}; give 1 or more")
    if not keep_every or min(keep_every) < 1 or course_starts < 1:
        raise InputError("--keep-every and --course-starts need numbers of 1 or more")
    suite = make_suite("thesis", starts, seed, held_out)
    given = settings_of(parameters or ())
    if "keep_every" in given:
        raise InputError("--parameters keep_every: give the numbers to measure as --keep-every")
    stated = settings_from(find_planner(planner, [planner]), **given)
    candidate = load_candidate(run, allow=allow)
    if candidate.note:
        print(candidate.note)
    suite = suited(suite, candidate.env.robot)
    robot = candidate.env.config.robot
    settings = stated.for_robot(robot)
    if note := stated.note_for(robot):
        print(note)
    further = parse_policies(policies or ())
    wanted = list(methods) if methods else [*METHODS, *further]
    contenders = make_contenders(candidate, further, wanted)
    fingerprints = {POLICY: candidate.fingerprint} if POLICY in wanted else {}
    fingerprints |= {name: fingerprint_of(path) for name, path in further.items() if name in wanted}
    head = Figures(
        created=now(),
        planner=planner,
        settings=settings.model_dump(mode="json"),
        policies=fingerprints,
        conditions=candidate.terms.conditions,
        seed=seed,
        held_out=held_out,
        scale=suite.scale,
    )
    found = _opened(out, head)
    write_figures(out, found)
    count = processes or os.cpu_count() or 1
    workers = planner_workers(count)
    try:
        with Reporter() as reporter:
            found = measure_figures(
                candidate.env,
                contenders.methods,
                replace(suite, cells=tuple(figure_cells(suite, course_starts).values())),
                Questions(settings, workers, tuple(keep_every)),
                FigureFile(Path(out), found),
                reporter.say,
            )
    finally:
        workers.close()
    print(f"written: {out}, {len(found.steps)} rows of {', '.join(wanted)}")
    return found


def _opened(out: Path, head: Figures) -> Figures:
    """Return what the file already holds, with the policies of both."""
    if not Path(out).is_file():
        return head
    before = read_figures(out)
    for name in ("planner", "settings", "conditions", "seed", "held_out", "scale"):
        if getattr(before, name) != getattr(head, name):
            raise InputError(
                f"{out} has {name} {getattr(before, name)}, not {getattr(head, name)}: give another"
                " --out"
            )
    for name, fingerprint in head.policies.items():
        if before.policies.get(name, fingerprint) != fingerprint:
            raise InputError(f"{out} was measured with another policy {name}: give another --out")
    return before.model_copy(update={"policies": before.policies | head.policies})
