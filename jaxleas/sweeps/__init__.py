"""Sweeps over configurations, and populations of policies trained in one compiled program.

Names are imported on first use: a sweep starts many workers, and each needs only some names.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from jaxleas.sweeps.border import open_sweep
    from jaxleas.sweeps.population_config import open_population
    from jaxleas.sweeps.population_loop import train_population
    from jaxleas.sweeps.results import TrialResult, best_of
    from jaxleas.sweeps.study import read_results
    from jaxleas.sweeps.sweep import run_sweep

_MODULES = {
    "TrialResult": "results",
    "best_of": "results",
    "open_population": "population_config",
    "open_sweep": "border",
    "read_results": "study",
    "run_sweep": "sweep",
    "train_population": "population_loop",
}
__all__ = [
    "TrialResult",
    "best_of",
    "open_population",
    "open_sweep",
    "read_results",
    "run_sweep",
    "train_population",
]


def __getattr__(name: str) -> Any:
    if name not in _MODULES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_MODULES[name]}"), name)
