"""The context of all workloads of a run: configuration, terrain, roofs and rival."""

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from benchmarks.arithmetic import env_limit, ppo_limit, step_work
from benchmarks.rival import Rival
from benchmarks.roofs import Roofs
from jaxleas.envs.steering import Steering, SteeringEnv, World
from jaxleas.training import AnyRun, load_run_config, training_world

ROOT = Path(__file__).resolve().parents[1]
CONFIG = ROOT / "configs" / "leas_p1.yaml"


@dataclass
class Context:
    """One run of the benchmarks.

    Attributes:
        runs: number of runs of each metric.
        rivals: Python interpreter with the rival, or None.
        config: configuration, by default the shipped one; tests give smaller ones.
        config_path: file of the configuration, for measurements in separate processes.
    """

    runs: int
    rivals: str | None = None
    config_path: Path = CONFIG

    @cached_property
    def config(self) -> AnyRun:
        """The configuration that is measured."""
        return load_run_config(self.config_path)

    @cached_property
    def env(self) -> SteeringEnv:
        """The task as configured."""
        return SteeringEnv(self.config.env)

    @cached_property
    def world(self) -> World:
        """The terrain as configured."""
        return training_world(self.config, Steering(self.config.env, self.config.terrain))

    @cached_property
    def roofs(self) -> Roofs:
        """The machine's roofs over this terrain."""
        return Roofs(self.world.atlas)

    @cached_property
    def rival(self) -> Rival:
        """The rival on this task."""
        return Rival(self.rivals, self.env, self.world, min(self.runs, 3))

    def env_limit(self, env: SteeringEnv, robots: int) -> float:
        """Return the bound of the environment alone [steps/s]."""
        rates = self.roofs.rates(self.config, env, robots, matrix=False)
        return env_limit(step_work(self.config, env), rates)

    def ppo_limit(self, config: AnyRun, env: SteeringEnv) -> float:
        """Return the bound of training end to end [steps/s]."""
        rates = self.roofs.rates(config, env, config.ppo.environments, matrix=True)
        return ppo_limit(step_work(config, env), rates)


def changed(config: AnyRun, **sections: dict[str, Any]) -> AnyRun:
    """Return a configuration with some fields of some sections changed, checked again."""
    document = config.model_dump()
    for section, fields in sections.items():
        document[section] |= fields
    return type(config).model_validate(document)
