"""Gait planning as a task of the house: phases, proposed by a policy and decided by CROC."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, ClassVar

import jax
import numpy as np

from jaxleas.dynamics import REACH_UNIT
from jaxleas.envs import Examination, Starts, StepResult, Task, TaskConfig, WorldsConfig
from jaxleas.envs.gait_planning.actions import command_of
from jaxleas.envs.gait_planning.candidates import candidate_of
from jaxleas.envs.gait_planning.config import GaitPlanningConfig, GaitWorldsConfig
from jaxleas.envs.gait_planning.deciding import decide_phases
from jaxleas.envs.gait_planning.footholds import footholds_are_safe, trunk_is_free
from jaxleas.envs.gait_planning.ground import Ground, make_ground
from jaxleas.envs.gait_planning.observation import observation_of
from jaxleas.envs.gait_planning.phases import Phases, PlanningState, base_distance
from jaxleas.envs.gait_planning.reach import reach_slack
from jaxleas.envs.gait_planning.reward import reward_of
from jaxleas.envs.gait_planning.starts import draw_starts
from jaxleas.envs.gait_planning.supports import in_contact
from jaxleas.terrain import FIELD_KINDS


class GaitPlanning(Task):
    """Support phases towards a goal; each transition is one linear program (D sec. III-A)."""

    Config: ClassVar[type[TaskConfig]] = GaitPlanningConfig
    Worlds: ClassVar[type[WorldsConfig]] = GaitWorldsConfig
    on_host = True
    groups = tuple(FIELD_KINDS)
    config: GaitPlanningConfig
    worlds: GaitWorldsConfig

    def make_world(self, seeds: Sequence[int], examined: bool) -> Ground:
        """Return one field of each seed."""
        del examined
        return make_ground(self.config, self.worlds, seeds)

    def draw_starts(
        self, world: Ground, key: np.random.Generator, count: int, examined: bool = False
    ) -> Starts:
        """Draw starts and goals anywhere on the fields."""
        config = self.config
        distance = config.examined_distance if examined else config.goal_distance
        return draw_starts(config, world, key, count, distance)

    def stagger(self, state: PlanningState, key: np.random.Generator) -> PlanningState:
        """Return first states as if their episodes had begun at different times."""
        steps = key.integers(self.config.episode_steps, size=len(state.step))
        return replace(state, step=steps.astype(np.int32))

    def advance(
        self,
        world: Ground,
        weights: Mapping[str, float],
        state: PlanningState,
        action: Any,
        disturbance: Any,
    ) -> tuple[PlanningState, StepResult]:
        """Return the next phases; where one is refused, the episode ends and its phase stays."""
        del disturbance
        config = self.config
        command = command_of(config, world, state, action)
        candidate = candidate_of(config, world, state, command)
        stands = footholds_are_safe(world, state.field, candidate)
        clear = trunk_is_free(config.robot, world, state.field, candidate)
        near = reach_slack(config.robot, candidate) > config.least_margin * REACH_UNIT
        asked = stands & clear & near
        feasible, unknown = self.decide(state.phase, candidate, command.times, asked)
        accepted = asked & feasible
        grounded = np.where(in_contact(candidate.support), state.grounded + 1, 0)
        episode = (state.goal, grounded)
        reward = reward_of(config.robot, weights, state.phase, candidate, episode)
        step = state.step + 1
        reached = accepted & (base_distance(candidate, state.goal) < config.goal_radius)
        answer: dict[str, Any] = {
            "reward": np.where(accepted, reward, -weights["reward.failure"]).astype(np.float32),
            "terminated": ~accepted,
            "truncated": accepted & (reached | (step >= config.episode_steps)),
            "reached": reached,
            "measures": {
                "unsafe_footholds": ~stands,
                "trunk_touches": stands & ~clear,
                "out_of_reach": stands & clear & ~near,
                "infeasible": asked & ~feasible,
                "unknown": unknown,
            },
        }
        phase = _select(accepted, candidate, state.phase)
        grounded, step = grounded.astype(np.int32), step.astype(np.int32)
        after = replace(state, phase=phase, grounded=grounded, step=step)
        return after, StepResult(**answer)

    def decide(
        self, phase: Phases, candidate: Phases, times: np.ndarray, asked: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return which transitions CROC accepts, and of which it found no verdict.

        Args:
            phase: present phases.
            candidate: phases that follow.
            times: t_E* and t_S [s].
            asked: which transitions are asked; others are not accepted.
        """
        return decide_phases(self.config, phase, candidate, times, asked)

    def look(self, world: Ground, state: PlanningState) -> dict[str, np.ndarray]:
        """Return what a policy sees."""
        return observation_of(self.config, world, state)

    def examination(self, held_out: Any) -> Examination:
        """Return the examination, whose cells are the kinds of fields."""
        cells = tuple(kind for kind in FIELD_KINDS if getattr(self.worlds.shares, kind))
        return Examination(held_out.starts, held_out.steps, cells)


def _select(flag: np.ndarray, chosen: Phases, other: Phases) -> Phases:
    """Return, robot by robot, `chosen` where `flag` is true and `other` elsewhere."""

    def pick(left: np.ndarray, right: np.ndarray) -> np.ndarray:
        return np.where(flag.reshape(flag.shape + (1,) * (left.ndim - flag.ndim)), left, right)

    return jax.tree.map(pick, chosen, other)
