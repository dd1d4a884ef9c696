"""Settings of the programs: how a guide becomes a problem, and how one problem is planned."""

from typing import Annotated, Literal, Self

from pydantic import Field, NonNegativeInt, PositiveFloat, PositiveInt

from jaxleas.configuration import Strict
from jaxleas.contacts.models import default_model_of, model_note
from jaxleas.contacts.problem import Model
from jaxleas.contacts.programs.attempt import MAX_COMBINATIONS
from jaxleas.contacts.programs.slack_weights import SlackWeights
from jaxleas.contacts.settings import PlannerSettings
from jaxleas.contacts.stepping import EVERY, WINDOW, Candidates

Cost = Literal["none", "linear", "quadratic"]


class ProgramSettings(PlannerSettings):
    """How a guide path becomes a contact problem (T 5.2.3), and how long a planner may take."""

    keep_every: PositiveInt = EVERY
    """number N: every N-th configuration of the guide path becomes a step, N_ref of T 5.2.3"""
    model: Model | None = None
    """two_com, with the centre of mass, or feet; by default two_com for a robot with two feet and
    step polytopes of its centre of mass, and feet for any other"""
    candidates: Candidates = "window"
    """window: parts of surfaces in a square around the root; rom: parts of surfaces in the range of
    motion of the moving leg"""
    window: Annotated[float, Field(gt=0.0, lt=100.0)] = WINDOW
    """length of the edges of the window [m]"""
    first_foot: str = "LF"
    """name of the foot that moves first; robots without a foot LF begin with their first foot,
    unless one is stated"""
    time_limit: PositiveFloat = 60.0
    """time limit for one guide path [s]; when it is over, the verdict is undecided"""

    def for_robot(self, robot: str) -> Self:
        """Return the settings with a model stated."""
        if self.model is not None:
            return self
        return self.model_copy(update={"model": default_model_of(robot)})

    def note_for(self, robot: str) -> str:
        """Return a line on why the model is feet, where nobody stated it."""
        return model_note(self.model, robot)


class MipSettings(ProgramSettings):
    """Settings of the mixed-integer planner."""


class Sl1mSettings(ProgramSettings):
    """Settings of SL1M."""

    max_combinations: NonNegativeInt = MAX_COMBINATIONS
    """number of combinations of surfaces to try for the undecided steps before giving up; 0: a path
    with an undecided step fails"""
    weights: SlackWeights = "uniform"
    """weights of the slacks: uniform, as published, or guide: the guide path chooses surfaces"""


class MipPlanSettings(Strict):
    """Settings of one plan by the mixed-integer planner."""

    cost: Cost = "none"
    """distance of footholds from the guide's reference ones that is minimised: none, linear (L1) or
    quadratic"""


class Sl1mPlanSettings(Strict):
    """Settings of one plan by SL1M."""

    max_combinations: NonNegativeInt = MAX_COMBINATIONS
    """number of combinations of surfaces to try for the undecided steps before giving up"""
