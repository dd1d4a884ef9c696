"""The terms on which walks are judged: the conditions that end them, and a refusal."""

from collections.abc import Collection
from dataclasses import dataclass
from typing import Any

from jaxleas.conditions import STANDARD, Named, harmless, permission, words_of
from jaxleas.envs.steering import SteeringConfig, SteeringEnv
from jaxleas.evaluation.refusal import Refusal
from jaxleas.types import InputError

_NEVER = ", and a surrogate's file, which another file names, cannot be allowed"


@dataclass(frozen=True)
class Terms:
    """What ends a walk: the same for a policy and for all that it is compared with.

    Attributes:
        conditions: names of the conditions: R* and C, or those that a person allowed.
        refusal: refusal of guide paths that are foreseen to fail; None: none is refused.
    """

    conditions: tuple[str, ...] = STANDARD
    refusal: Refusal | None = None

    @classmethod
    def of(
        cls, trained_under: tuple[Named, ...], refusal: Refusal | None, allow: Collection[str] = ()
    ) -> "Terms":
        """Return the terms for a policy: R* and C, or its own conditions where they are allowed.

        Args:
            trained_under: conditions under which the policy was trained.
            refusal: refusal of guide paths, if any.
            allow: user's own code that may be run, as MODULE:CLASS.

        Raises:
            InputError: some of the policy's conditions are allowed, and others are not.
        """
        named = tuple(each for each in trained_under if isinstance(each, str))
        if not set(named) & set(allow):
            return cls(STANDARD, refusal)
        if not harmless(trained_under, allow):
            raise InputError(
                f"the policy was trained under {words_of(trained_under)}: allow all of them or none"
                f"{permission(trained_under, allow) or _NEVER}"
            )
        return cls(named, refusal)

    @property
    def are_standard(self) -> bool:
        """Whether results count as the policy's own: R* and C judge, and nothing is refused."""
        return self.conditions == STANDARD and self.refusal is None

    def env(self, config: SteeringConfig) -> SteeringEnv:
        """Return the environment to judge in, for a task.

        Raises:
            InputError: the surrogate is for another robot or observation, or a condition cannot be
                made.
        """
        judged = config.model_copy(update={"conditions": self.conditions})
        foresight = None if self.refusal is None else self.refusal.foresight(config)
        # Conditions of one's own are among these only where a person allowed them.
        return SteeringEnv(judged, foresight=foresight, allow=self.conditions)

    def note_for(self, trained_under: tuple[Named, ...], allow: Collection[str] = ()) -> str:
        """Return a sentence where conditions of one's own are in play, else "".

        Args:
            trained_under: conditions under which the policy was trained.
            allow: user's own code that may be run, as MODULE:CLASS.
        """
        if harmless(trained_under):
            return ""
        if self.conditions == trained_under:
            return f"the policy is judged under its own conditions, {words_of(trained_under)}"
        return (
            f"the policy was trained under {words_of(trained_under)}, and is judged under"
            f" {words_of(self.conditions)}{permission(trained_under, allow)}"
        )

    def describe(self) -> dict[str, Any]:
        """Return what a result file records of them."""
        refused = None if self.refusal is None else self.refusal.describe()
        return {"conditions": self.conditions, "foresight": refused}
