"""The distillation loop: practise and judge, until the exact success stops rising.

The exact planner's verdict on held-out terrain is the only success that counts; a surrogate is
never more than an accelerator (systems: labels, surrogates, planner-aware training).
"""

import time

from jaxleas.distillation.against_planner import AgainstPlanner
from jaxleas.distillation.against_surrogate import AgainstSurrogate
from jaxleas.distillation.folder import read_done
from jaxleas.distillation.judging import (
    Examiner,
    exact_success,
    judge_round,
    mean_robustness,
    summary,
)
from jaxleas.distillation.practice import practice_config, practise, read_learned
from jaxleas.distillation.round_result import RoundResult
from jaxleas.distillation.rounds import (
    Mode,
    Practised,
    Say,
    keep_rounds,
    known_rounds,
)
from jaxleas.distillation.workplace import Workplace
from jaxleas.evaluation import refined_name
from jaxleas.guide import LEAS
from jaxleas.training import read_policy

_MODES = {"surrogate": AgainstSurrogate, "faithful": AgainstPlanner}


def run_rounds(place: Workplace, say: Say) -> list[RoundResult]:
    """Continue to the end from wherever the folder stands; return the table of all rounds.

    Args:
        place: workplace of the distillation.
        say: callable that shows what is being done.
    """
    mode: Mode = _MODES[place.config.mode](place)
    known = known_rounds(place.folder)
    try:
        practised = _begin(place, say)
        results = [known.get(0) or _judge(place, 0, practised, say)]
        for number in range(1, place.config.rounds + 1):
            practised = mode.practise(number, practised, say)
            results.append(known.get(number) or _judge(place, number, practised, say))
            keep_rounds(place.folder, results, mode)
            in_vain = number - max(results, key=lambda each: each.success).round
            if in_vain >= place.config.patience:
                say(f"no rise of the exact success for {in_vain} rounds: done")
                break
        return results
    finally:
        place.workers.close()


def _begin(place: Workplace, say: Say) -> Practised:
    """Return the initial policy, and what it has learned, practised without a surrogate."""
    steps = place.config.practice.steps_before
    if not steps:
        return Practised(place.policy, place.learned)
    folder = place.folder.round(0)
    if not folder.practised.is_file():
        say("round 0: practice without surrogate")
        config = practice_config(place.config, place.run_config, steps)
        practise(folder, config, None, place.learned, place.devices, place.allow)
    seconds = {"practice": read_done(folder.practised, "seconds")["seconds"]}
    return Practised(read_policy(folder.policy), read_learned(folder.run), seconds=seconds)


def _judge(place: Workplace, number: int, practised: Practised, say: Say) -> RoundResult:
    """Return a row of the table: the exact planner's verdict on the round's policy."""
    begun, planner = time.perf_counter(), place.config.planner
    cells = judge_round(
        place.folder.round(number).judged,
        practised.policy,
        refined_name(planner) if number else LEAS.key,
        Examiner(planner, place.judge),
        place.config.judge,
        lambda words: say(f"round {number}: the exact planner judges {words}", passing=True),
    )
    seconds = practised.seconds | {"judgement": round(time.perf_counter() - begun, 1)}
    success, by_cell = exact_success(cells), dict(summary(cells))
    say(f"round {number}: exact success {100 * success:.1f} %")
    return RoundResult(
        round=number,
        success=success,
        cells=by_cell,
        labels=practised.labels,
        seconds=seconds,
        surrogate=practised.surrogate,
        starts=sum(cell.starts for cell in cells),
        robustness=mean_robustness(cells),
    )
