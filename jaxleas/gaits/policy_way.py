"""Ways that a policy of gait planning takes: its own answers, and draws where they are refused."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array
from jaxtyping import Float

from jaxleas.envs.gait_planning import (
    Command,
    GaitPlanning,
    GaitWorldsConfig,
    Ground,
    PlanningState,
    command_of,
)
from jaxleas.gaits.gait import Ending, Gait, gait_of, taken
from jaxleas.training import Policy

CAUSES = {
    "unsafe_footholds": "a foothold is too near an edge",
    "trunk_touches": "the terrain reaches the trunk",
    "out_of_reach": "a foot is out of reach",
    "infeasible": "the program is infeasible",
    "unknown": "the program did not converge",
}


@dataclass(frozen=True)
class Retries:
    """What is tried where a policy's phase is refused.

    Attributes:
        draws: number of phases drawn from the policy's distribution, of which the first accepted
            one is taken.
        back: how often in a row the way goes back where no draw is accepted: one phase, then two,
            and so on, until it gets farther than before; never without draws.
        seed: seed of the draws.
    """

    draws: int = 63
    back: int = 20
    seed: int = 0


NO_RETRIES = Retries(draws=0)


class PolicyWay(NamedTuple):
    """A policy's way.

    Attributes:
        gait: states and commands, all accepted; the farthest, where the goal is not reached.
        cause: why the policy's own next phase was refused; "" where none was.
        programs: number of phases that were proposed.
    """

    gait: Gait
    cause: str
    programs: int


def walk_policy(
    policy: Policy,
    ground: Ground,
    start: PlanningState,
    most: int,
    retries: Retries = NO_RETRIES,
) -> PolicyWay:
    """Return the way of one robot whose policy proposes its phases.

    Each phase is the likeliest one of the policy's distribution, if it is accepted.

    Args:
        policy: policy of gait planning.
        ground: ground of the task.
        start: state to begin with, with its goal.
        most: largest number of phases.
        retries: what is tried where a phase is refused.
    """
    walker = _Walker(policy, ground, retries)
    states, commands = [start], []
    farthest: tuple[list[PlanningState], list[Command]] = (states, commands)
    ending: Ending = "budget"
    setbacks = 0
    while len(commands) < most:
        # After a setback the policy's own answer would lead to the same refusal.
        step = walker.step_from(states[-1], own=not setbacks)
        if step is None:
            setbacks += 1
            if not retries.draws or setbacks > retries.back:
                ending = "refused"
                break
            kept = max(0, len(commands) - setbacks)
            states, commands = states[: kept + 1], commands[:kept]
            continue
        states, commands = [*states, step.after], [*commands, step.command]
        if len(commands) > len(farthest[1]):
            farthest, setbacks = (states, commands), 0
        if step.reached:
            ending = "reached"
            farthest = states, commands
            break
    cause = walker.cause if ending == "refused" else ""
    return PolicyWay(gait_of(ending, *farthest), cause, walker.programs)


class _Step(NamedTuple):
    after: PlanningState
    command: Command
    reached: bool


class _Walker:
    """Takes single phases."""

    def __init__(self, policy: Policy, ground: Ground, retries: Retries) -> None:
        self._policy, self._ground, self._retries = policy, ground, retries
        self._task = GaitPlanning(policy.config, GaitWorldsConfig())
        self._weights = {f"reward.{name}": value for name, value in policy.config.reward}
        self._key = jax.random.key(retries.seed)
        self.cause, self.programs = "", 0

    def step_from(self, state: PlanningState, own: bool) -> _Step | None:
        """Return the next phase, or None where all proposed ones are refused."""
        # An episode of training is cut after fewer phases.
        state = replace(state, step=np.zeros_like(state.step))
        for actions in self._proposed(state, own):
            many = taken(state, np.zeros(len(actions), int))
            after, result = self._task.advance(self._ground, self._weights, many, actions, ())
            self.programs += len(actions)
            accepted = np.flatnonzero(~np.asarray(result.terminated))
            if len(accepted):
                first = accepted[:1]
                command = command_of(
                    self._policy.config, self._ground, taken(many, first), actions[first]
                )
                return _Step(taken(after, first), command, bool(result.reached[first[0]]))
            if own:
                self.cause = _cause_of(result)
                own = False  # what follows are draws
        return None

    def _proposed(
        self, state: PlanningState, own: bool
    ) -> Iterator[Float[np.ndarray, "phases size"]]:
        """Yield the policy's own answer, then its draws."""
        seen = self._task.look(self._ground, state)
        if own:
            yield np.asarray(_own(self._policy, seen))
        if self._retries.draws:
            self._key, key = jax.random.split(self._key)
            yield np.asarray(_drawn(self._policy, seen, key, self._retries.draws))


@jax.jit  # of functions of the module: they are compiled once, not for each way
def _own(policy: Policy, seen: Mapping[str, Array]) -> Array:
    return policy.action(seen)


@partial(jax.jit, static_argnames="count")
def _drawn(policy: Policy, seen: Mapping[str, Array], key: Array, count: int) -> Array:
    signature, answer = policy.signature, policy.answer(seen)
    many = jnp.broadcast_to(answer, (count, answer.shape[-1]))
    noise = signature.draw_noise(key, (count,))
    return signature.action(signature.sample(signature.distributions(many), noise))


def _cause_of(result: Any) -> str:
    return next(words for name, words in CAUSES.items() if result.measures[name][0])
