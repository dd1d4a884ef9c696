"""What a task's methods must give: each answer is compared with the protocol.

Arrays may be abstract (`jax.eval_shape`): only structure, shapes and types are looked at, so that
tasks on the device are checked without computing anything.
"""

from collections.abc import Mapping
from typing import Any

from jaxleas.envs.array_checks import kind_of, require_array, require_rows, require_same
from jaxleas.envs.signature import Signature
from jaxleas.envs.task_values import Examination, Starts, StepResult
from jaxleas.types import InputError

LOGGED = ("reward", "failures_per_1000_steps", "goals_per_1000_steps", "valid_starts", "episodes")
"""Measures that the training logs of every task as `walk/NAME`."""


def require_starts(answer: Any, count: int) -> None:
    """Refuse what `draw_starts` may not give.

    Args:
        answer: answer of the task's method.
        count: number of candidates that it was asked for.

    Raises:
        InputError: one sentence says what was given, and what would do.
    """
    if not isinstance(answer, Starts):
        raise InputError(f"draw_starts gives {kind_of(answer)}; give Starts(state, valid, group)")
    require_rows("draw_starts: state", answer.state, (count,), "candidates")
    require_array("draw_starts: valid", answer.valid, (count,), "truth values")
    require_array("draw_starts: group", answer.group, (count,), "whole numbers")


def require_step(answer: Any, state: Any, robots: int) -> None:
    """Refuse what `advance` may not give.

    Args:
        answer: answer of the task's method.
        state: state that it was given.
        robots: number of robots.

    Raises:
        InputError: one sentence says what was given, and what would do.
    """
    pair = isinstance(answer, tuple) and len(answer) == 2
    if not pair or not isinstance(answer[1], StepResult):
        given = ", ".join(map(kind_of, answer)) if isinstance(answer, tuple) else kind_of(answer)
        raise InputError(f"advance gives {given}; give two: the next state, and a StepResult")
    after, result = answer
    require_same("advance", after, state)
    require_array("advance: reward", result.reward, (robots,), "numbers")
    for name in ("terminated", "truncated", "reached"):
        require_array(f"advance: {name}", getattr(result, name), (robots,), "truth values")
    if not isinstance(result.measures, Mapping):
        raise InputError(f"advance: measures is {kind_of(result.measures)}; give numbers by name")
    for name, values in result.measures.items():
        if not isinstance(name, str) or name in LOGGED:
            raise InputError(
                f"advance: a measure has the name {name!r}; give a text other than"
                f" {', '.join(LOGGED)}, which are logged of every task"
            )
        require_array(f"advance: the measure {name}", values, None, "values")


def require_observation(answer: Any, signature: Signature, robots: int) -> None:
    """Refuse an observation that is not as the signature says.

    Args:
        answer: answer of `look`.
        signature: signature of the task.
        robots: number of robots.

    Raises:
        InputError: one sentence says what was given, and what would do.
    """
    names = [part.name for part in signature.parts]
    if not isinstance(answer, Mapping):
        if len(names) > 1 or answer is None:
            raise InputError(
                f"look gives {kind_of(answer)}; give arrays by part: {', '.join(names)}"
            )
        answer = {names[0]: answer}
    if set(answer) != set(names):
        raise InputError(
            f"look gives {', '.join(map(str, answer)) or 'nothing'}, but the parts of the signature"
            f" are {', '.join(names)}: give the same"
        )
    for part in signature.parts:
        wanted = (robots, *part.shape)
        require_array(f"look: the part {part.name}", answer[part.name], wanted, "values")


def require_examination(answer: Any, groups: tuple[str, ...]) -> None:
    """Refuse what `examination` may not give.

    Args:
        answer: answer of the task's method.
        groups: names of the groups of the task's starts.

    Raises:
        InputError: one sentence says what was given, and what would do.
    """
    if not isinstance(answer, Examination):
        raise InputError(f"examination gives {kind_of(answer)}; give an Examination(starts, steps)")
    if not (answer.starts >= 1 and answer.steps >= 1):
        raise InputError(f"{answer} measures nothing: give 1 start and 1 step at least")
    for name, cells in (("cells", answer.cells), ("stops", answer.stops)):
        if not isinstance(cells, tuple) or set(cells) - set(groups):
            raise InputError(
                f"examination has the {name} {cells!r}; give a tuple of groups of the task:"
                f" {', '.join(groups)}"
            )
    if answer.by_worst and not (answer.cells or answer.stops):
        raise InputError(
            "examination is by_worst, but has neither cells nor stops to be the worst of: name some"
            f" of the groups {', '.join(groups)}"
        )
