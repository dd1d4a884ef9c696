"""One trial's values, drawn by Optuna from the space of a sweep."""

import json
from typing import Any

from optuna.trial import BaseTrial

from jaxleas.sweeps.border import Sweep
from jaxleas.sweeps.config import Dimension
from jaxleas.sweeps.space import allowed


def draw(trial: BaseTrial, sweep: Sweep) -> dict[str, Any]:
    """Return the values of the searched fields, in the space's order.

    A field whose condition does not hold is left out. Values that the trial already has, as after a
    kill between two draws, are kept.

    Args:
        trial: Optuna trial that draws and stores the values.
        sweep: sweep with the search space.
    """
    values: dict[str, Any] = {}
    for name, dimension in sweep.config.space.items():
        conditions = dimension.only_when.items()
        if all(other in values and values[other] in allowed(w) for other, w in conditions):
            values[name] = _draw_one(trial, name, dimension, name in sweep.whole)
    return values


def _draw_one(trial: BaseTrial, name: str, dimension: Dimension, whole: bool) -> Any:
    if dimension.choices is not None:
        # Optuna's choices are scalars: a list is represented by its text.
        texts = {_as_scalar(choice): choice for choice in dimension.choices}
        return texts[trial.suggest_categorical(name, list(texts))]
    (low, high), step = dimension.ends, dimension.step
    if whole:
        each = 1 if step is None else int(step)
        return trial.suggest_int(name, int(low), int(high), step=each, log=dimension.log)
    return trial.suggest_float(name, low, high, step=step, log=dimension.log)


def _as_scalar(choice: Any) -> Any:
    return choice if isinstance(choice, bool | int | float | str) else json.dumps(choice)
