"""Timing: one warm-up, then a few runs, each long enough to be meaningful."""

import math
import time
from collections.abc import Callable
from typing import Any

import jax

from jaxleas.training import MOST_AHEAD


def seconds_a_call(call: Callable[[], Any], runs: int, least_seconds: float = 0.5) -> list[float]:
    """Return the seconds that a call takes, one mean per run.

    Args:
        call: function to time; it may return before the device is done; its results are awaited.
        runs: number of runs.
        least_seconds: approximate duration of a run, which repeats the call [s].
    """
    jax.block_until_ready(call())  # compiles
    begin = time.perf_counter()
    jax.block_until_ready(call())
    once = time.perf_counter() - begin
    repeats = max(1, math.ceil(least_seconds / max(once, 1e-7)))
    if repeats > 1:  # a single short call seems too long: its first estimate is refined
        repeats = max(1, math.ceil(least_seconds / max(_mean(call, min(repeats, 10)), 1e-7)))
    return [_mean(call, repeats) for _ in range(runs)]


def _mean(call: Callable[[], Any], repeats: int) -> float:
    begin = time.perf_counter()
    result = None
    for _ in range(repeats):
        result = call()
    jax.block_until_ready(result)
    return (time.perf_counter() - begin) / repeats


def not_far_ahead(call: Callable[[], Any]) -> Callable[[], Any]:
    """Return a call that waits for the results of earlier ones, as training does."""
    ahead: list[Any] = []

    def patient() -> Any:
        answer = call()
        ahead.append(answer)
        if len(ahead) >= MOST_AHEAD:
            jax.block_until_ready(ahead.pop(0))
        return answer

    return patient
