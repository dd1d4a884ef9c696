"""How tracking a plan ended, as a sentence."""

import numpy as np

from jaxleas.controllers import PhaseTracks
from jaxleas.crossing.followed_plan import Tracking
from jaxleas.crossing.in_words import CAUSES
from jaxleas.types import JaxleasError


class NotFollowedError(JaxleasError):
    """A plan that was not followed to its end: an answer, not a bad input.

    Attributes:
        exit_code: exit code of a command that ends so: what a shell reports for Ctrl-C if a person
            stopped it.
    """

    def __init__(self, made: Tracking, tracks: PhaseTracks) -> None:
        self.exit_code = 130 if made.outcome == "interrupted" else 1
        super().__init__(tracking_in_words(made, tracks))


def tracking_in_words(made: Tracking, tracks: PhaseTracks) -> str:
    """Return how a robot followed its plan.

    Args:
        made: what became of it.
        tracks: its plan, of one robot.
    """
    ends = {
        "followed": "followed to the end of the plan",
        "astray": "at the end of the plan, but not at its place",
        "fell": f"fell: {CAUSES.get(made.cause, made.cause)}",
        "time": "its time was over",
        "interrupted": "it was stopped",
    }
    x, y, _ = made.com
    said = f"{ends[made.outcome]}, after {made.time:.1f} s at ({x:.2f}, {y:.2f}) m"
    said += f", in support {made.support} of {int(tracks.lengths[0])}"
    if len(made.base_errors):
        mean, most = 100 * made.base_errors.mean(), 100 * made.base_errors.max()
        said += f"; centre of mass off by {mean:.1f} cm, {most:.1f} cm at most"
    if len(made.tracked):
        said += (
            f"; {int(np.sum(made.tracked))} of {len(made.tracked)} footholds within 5 cm, standing"
            f" feet off by {100 * made.fter:.1f} cm"
        )
    if len(made.landing_errors):
        mean, most = 100 * made.landing_errors.mean(), 100 * made.landing_errors.max()
        said += f", landings by {mean:.1f} cm, {most:.1f} cm at most"
    return said
