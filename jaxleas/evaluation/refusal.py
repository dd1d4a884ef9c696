"""The risk dial at run time: guide paths that a surrogate foresees to fail are refused."""

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from jaxleas.envs.steering import SteeringConfig
from jaxleas.surrogates import Surrogate, SurrogateForesight, read_surrogate, require_fit
from jaxleas.types import InputError


@dataclass(frozen=True)
class Refusal:
    """A walk is stopped before its probability of success falls below the threshold.

    Attributes:
        surrogate: surrogate that foresees failure.
        threshold: least probability, by the surrogate, that the planner gets this far.
        fingerprint: SHA-256 of the surrogate's file.
        where: name of the surrogate in errors.
    """

    surrogate: Surrogate
    threshold: float
    fingerprint: str
    where: str

    def foresight(self, config: SteeringConfig) -> SurrogateForesight:
        """Return the foresight that ends walks in an environment of this configuration.

        Raises:
            InputError: the surrogate is for another robot or observation.
        """
        require_fit(self.surrogate, config, where=self.where)
        return SurrogateForesight(self.surrogate, self.threshold)

    def describe(self) -> dict[str, Any]:
        """Return what an evaluation file records of the refusal."""
        return {
            "surrogate": self.fingerprint,
            "planner": self.surrogate.identity.planner,
            "threshold": self.threshold,
        }


def load_refusal(
    surrogate: Path | None, threshold: float | None, planners: Sequence[str] = ()
) -> Refusal | None:
    """Return the refusal requested on the command line, if any.

    Args:
        surrogate: file of the surrogate.
        threshold: least probability of success.
        planners: exact planners that will judge; empty: the conditions alone.

    Raises:
        InputError: one of the two is missing, the file is not a surrogate or does not stand in for
            any of the planners, or the threshold is not a probability below 1.
    """
    if surrogate is None and threshold is None:
        return None
    if surrogate is None:
        raise InputError(f"--threshold {threshold:g} needs a --surrogate to ask")
    if threshold is None:
        raise InputError(f"--surrogate {surrogate} needs a --threshold, as 0.9")
    if not 0.0 <= threshold < 1.0:
        raise InputError(f"--threshold is {threshold:g}; give a probability, from 0 to below 1")
    found = read_surrogate(surrogate)
    mine = found.identity.planner
    if planners and mine not in planners:
        raise InputError(
            f"{surrogate} stands in for the {mine} planner, but {', '.join(planners)} will judge:"
            f" give a surrogate of theirs, or --planners {mine}"
        )
    fingerprint = hashlib.sha256(Path(surrogate).read_bytes()).hexdigest()
    return Refusal(found, threshold, fingerprint, str(surrogate))
