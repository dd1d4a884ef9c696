"""A policy, found by its path, judged on a suite by its name."""

import hashlib
import time
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from pathlib import Path

from jaxleas.envs.steering import SteeringEnv
from jaxleas.evaluation.judge import judge
from jaxleas.evaluation.refusal import Refusal
from jaxleas.evaluation.report_basis import ReportBasis
from jaxleas.evaluation.result_file import (
    Evaluation,
    MapCells,
    now,
    read_evaluation,
    write_evaluation,
)
from jaxleas.evaluation.starts import Grounds, make_grounds
from jaxleas.evaluation.suited import suited
from jaxleas.evaluation.suites import REPORTED, REPORTED_IF_EVALUATED, Suite, make_suite
from jaxleas.evaluation.terms import Terms
from jaxleas.files import policy_path
from jaxleas.guide import BASELINES, LEAS, SteeringMethod, policy_file, read_steering_policy
from jaxleas.terrain import NoiseConfig, scale_for
from jaxleas.types import InputError

POLICY = LEAS.key


@dataclass(frozen=True)
class Candidate:
    """What is judged.

    Attributes:
        path: path that it was loaded from.
        fingerprint: SHA-256 of its file.
        env: the task it was trained for.
        methods: the policy as a steering method first, then the baselines.
        terms: terms on which it is judged, and all that it is compared with.
        note: sentence on conditions of one's own that it was trained under; "": there are none.
    """

    path: Path
    fingerprint: str
    env: SteeringEnv
    methods: Mapping[str, SteeringMethod]
    terms: Terms
    note: str = ""


def load_candidate(
    path: str | Path, refusal: Refusal | None = None, allow: Collection[str] = ()
) -> Candidate:
    """Load a run folder, a policy.npz or an .onnx file, with the baselines to compare with.

    Args:
        path: path of the policy, or `pretrained:NAME`.
        refusal: refusal of guide paths that are foreseen to fail.
        allow: each MODULE:CLASS among the policy's conditions that is to judge it, too; by default
            R* and C judge every policy.

    Raises:
        InputError: there is no policy, it cannot be used, or the surrogate is not for it.
    """
    path = policy_path(path)
    policy = read_steering_policy(path)
    terms = Terms.of(policy.config.conditions, refusal, allow)
    env = terms.env(policy.config)
    methods = {each.key: each.make(env, policy) for each in (LEAS, *BASELINES.values())}
    file = policy_file(path) if path.is_dir() else path
    fingerprint = hashlib.sha256(file.read_bytes()).hexdigest()
    note = terms.note_for(policy.config.conditions, allow)
    return Candidate(path, fingerprint, env, methods, terms, note)


def examine(
    candidate: Candidate,
    suite: Suite,
    *,
    baseline: bool = True,
    progress: Callable[[str], None] = lambda _: None,
    grounds: Grounds | None = None,
    noise: NoiseConfig | None = None,
) -> Evaluation:
    """Judge a candidate on a suite.

    Args:
        candidate: policy to judge.
        suite: suite to judge it on.
        baseline: whether RB-Lin and RB-Kino are judged as well.
        progress: callable that is given the cell that is being walked, in words.
        grounds: height maps of the suite's scenes, if already made.
        noise: what is wrong with the maps that robots see; None: nothing.

    Raises:
        InputError: no height is known around any start of a cell.
    """
    begin = time.perf_counter()
    methods = {
        name: method for name, method in candidate.methods.items() if baseline or name == POLICY
    }
    if noise is not None:
        plain = make_grounds(suite.cells) if grounds is None else grounds
        grounds = plain.seen_through(noise, suite.stream())
    cells = judge(candidate.env, methods, suite, progress, grounds)
    return Evaluation(
        suite=suite.name,
        policy=str(candidate.path),
        fingerprint=candidate.fingerprint,
        **candidate.terms.describe(),
        guard=candidate.env.config.guard,
        noise=noise,
        map_cells=None if grounds is None else MapCells.of(grounds.count),
        robot=candidate.env.config.robot,
        scale=suite.scale,
        seed=suite.seed,
        created=now(),
        seconds=round(time.perf_counter() - begin, 2),
        cells=tuple(cells),
    )


def evaluation_file(run: Path, suite: str) -> Path:
    """Return where a run folder keeps its evaluation on a suite."""
    return run / "evaluation" / f"{suite}.json"


def run_evaluations(
    candidate: Candidate,
    run: Path,
    basis: ReportBasis,
    progress: Callable[[str], None] = lambda _: None,
) -> list[Evaluation]:
    """Return the evaluations of a run's report: those it holds, and the others, made and kept now.

    An evaluation of another policy than the run's present one, on scenes of another scale, or an
    unreadable one, is made again.

    Args:
        candidate: policy of the run.
        run: folder of the run.
        basis: suites and terrain, shared with the report's pictures.
        progress: callable that is given the cell that is being walked, in words.
    """
    scale = scale_for(candidate.env.robot)
    evaluations = []
    for name in REPORTED:
        path = evaluation_file(run, name)
        evaluation = kept_evaluation(path, candidate)
        if evaluation is None or evaluation.scale != scale.leg:
            suite = basis.suites.get(name)
            grounds = None if suite is None else basis.grounds
            evaluation = examine(
                candidate,
                suite or suited(make_suite(name), candidate.env.robot),
                progress=progress,
                grounds=grounds,
            )
            write_evaluation(path, evaluation)
        evaluations.append(evaluation)
    more = (
        kept_evaluation(evaluation_file(run, name), candidate) for name in REPORTED_IF_EVALUATED
    )
    return [*evaluations, *(each for each in more if each is not None)]


def kept_evaluation(path: Path, candidate: Candidate) -> Evaluation | None:
    """Return the evaluation kept in that file, if it judges this very policy."""
    if not path.is_file():
        return None
    try:
        evaluation = read_evaluation(path)
    except InputError:  # of another version, or damaged: it may be made again
        return None
    return evaluation if evaluation.fingerprint == candidate.fingerprint else None


def keep_evaluation(run: Path, candidate: Candidate, evaluation: Evaluation) -> None:
    """Keep an evaluation in its run folder, unless the one there has more starts.

    A quick look with few starts must not replace the evaluation that the report uses.
    """
    path = evaluation_file(run, evaluation.suite)
    kept = kept_evaluation(path, candidate)
    if kept is None or kept.scale != evaluation.scale or _walks(kept) <= _walks(evaluation):
        write_evaluation(path, evaluation)


def _walks(evaluation: Evaluation) -> int:
    return sum(cell.starts for cell in evaluation.cells)
