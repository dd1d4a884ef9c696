"""Programs of transitions solved on the host by compiled loops, in doubles, on several threads."""

import importlib
import importlib.util
import math
import os
from concurrent.futures import ThreadPoolExecutor
from types import ModuleType

import numpy as np
from jaxtyping import Float

from jaxleas.dynamics.croc.program import Programs, Rows
from jaxleas.dynamics.croc.solution import Ended, Solutions
from jaxleas.types import InputError

_PIECE = 64  # programs of one task of a thread


def solve_on_host(
    programs: Programs, threads: int | None = None, asked: float = math.nan
) -> Solutions:
    """Return the largest margin of each program.

    Args:
        programs: programs in NumPy arrays, of any batch shape.
        threads: number of threads; None for one on each core.
        asked: margin of which it is only asked whether it can be reached, which takes fewer
            iterations; NaN for the largest margin.

    Raises:
        InputError: numba is not installed.
    """
    batch = programs.push_share.shape[:-2]
    phases, instants = programs.push_share.shape[-2:]
    count, points = int(np.prod(batch)), programs.standing.shape[-1]
    origin, arrays = _flat(programs, count)
    answers = Solutions(
        np.zeros(count),
        np.zeros((count, 3)),
        np.zeros((count, phases, instants, points, 3)),
        np.zeros(count, np.int32),
        np.zeros(count, np.int32),
    )
    _solve_in_pieces(arrays, answers, threads or available_cores(), asked)
    margin = np.where(answers.ended == Ended.UNSUPPORTED, -np.inf, answers.margin)
    whole = (margin, answers.free_point + origin, *answers[2:])
    return Solutions(*(array.reshape(*batch, *array.shape[1:]) for array in whole))


def has_compiler() -> bool:
    """Return whether numba, which compiles the loops, is installed."""
    return importlib.util.find_spec("numba") is not None


def available_cores() -> int:
    """Return the number of cores that this process may use."""
    is_known = hasattr(os, "sched_getaffinity")  # not on macOS
    return len(os.sched_getaffinity(0)) if is_known else os.cpu_count() or 1


def _solve_in_pieces(
    arrays: list[np.ndarray], answers: Solutions, threads: int, asked: float
) -> None:
    kernel = _kernel("kernel_batch")
    problem = _kernel("kernel_newton").Problem

    def solve(piece: slice) -> None:
        first, limits, *rest = (array[piece] for array in arrays)
        fields = [first, *rest]
        kernel.solve_all(
            problem(*fields[:3], 0.0, *fields[3:]),
            limits,
            kernel.Answers(*(array[piece] for array in answers)),
            asked,
        )

    pieces = [slice(k, k + _PIECE) for k in range(0, len(answers.margin), _PIECE)]
    if threads == 1 or len(pieces) == 1:
        for piece in pieces:
            solve(piece)
        return
    with ThreadPoolExecutor(threads) as pool:
        list(pool.map(solve, pieces))


def _kernel(name: str) -> ModuleType:
    if not has_compiler():
        raise InputError(
            "the compiled solver of transitions needs numba: pip install 'jaxleas[gaits]', or"
            " choose the solver 'jax'"
        )
    return importlib.import_module(f"jaxleas.dynamics.croc.{name}")


def _flat(programs: Programs, count: int) -> tuple[Float[np.ndarray, "N 3"], list[np.ndarray]]:
    """Return the origins, and the arrays that the loops read: arms, limits, then the others."""

    def flat(array: np.ndarray, axes: int) -> np.ndarray:
        shape = (count, *array.shape[len(array.shape) - axes :])
        kind = array.dtype if array.dtype == np.bool_ else np.float64
        return np.ascontiguousarray(array.reshape(shape), dtype=kind)

    def block(rows: Rows) -> list[np.ndarray]:
        turned = np.swapaxes(rows.rows, -1, -2)
        return [flat(turned, 3), flat(rows.share, 2), flat(rows.bounds, 3)]

    return flat(programs.origin, 1), [
        flat(programs.arms, 3),
        flat(programs.limit, 0),
        flat(programs.faces, 4),
        flat(programs.standing, 2),
        flat(programs.push, 3),
        flat(programs.push_share, 2),
        flat(programs.turn, 3),
        flat(programs.turn_slope, 3),
        *block(programs.reach),
        *block(programs.acceleration),
    ]
