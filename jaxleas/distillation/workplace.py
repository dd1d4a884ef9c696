"""The shared values of a distillation's stages: planner, policy's task, training terrain."""

from collections.abc import Collection
from functools import cached_property

from jaxleas.contacts import PlannerSettings, find_planner, settings_from
from jaxleas.distillation.config import DistillationConfig
from jaxleas.distillation.folder import DistillationFolder
from jaxleas.distillation.labelling import Ground
from jaxleas.distillation.practice import read_run
from jaxleas.distillation.widening import widen, widen_policy
from jaxleas.envs.steering import Steering, SteeringEnv
from jaxleas.labels import PLANNER_MODULES, Judge
from jaxleas.surrogates import Identity
from jaxleas.terrain import generate_arena
from jaxleas.training import POLICY_FILE, Devices, Policy, one_device, read_policy, training_world
from jaxleas.workers import ProcessWorkers


class Workplace:
    """A distillation's planner, task and terrain, and what its initial policy has learned.

    Attributes:
        config: configuration of the distillation.
        folder: folder of the distillation.
        settings: resolved settings of the planner that judges.
        labelling: resolved settings of the planner that labels.
        run_config: configuration of the policy's training, with the observation layout of practice.
        learned: networks learned by the initial policy.
        env: steering task of the policy.
        devices: devices that share the practice.
        allow: user's own code that may be run, as MODULE:CLASS.
        workers: workers that ask the planner.
        judge: planner that judges, with its workers.
    """

    def __init__(
        self,
        config: DistillationConfig,
        folder: DistillationFolder,
        start: str,
        processes: int,
        devices: Devices | None = None,
        allow: Collection[str] = (),
    ):
        """Prepare the workplace; nothing is computed yet.

        Args:
            config: configuration of the distillation.
            folder: folder to work in.
            start: run folder of the policy to begin with.
            processes: number of processes that ask the planner.
            devices: devices that share the practice; by default the first.
            allow: user's own code that may be run, as MODULE:CLASS: planner and conditions.

        Raises:
            InputError: the planner's parameters cannot be used, or there is no such run.
        """
        self.config, self.folder, self._start = config, folder, start
        self.allow = tuple(allow)
        planner = find_planner(config.planner, allow)
        settings: PlannerSettings = settings_from(planner, **config.parameters)
        labelling: PlannerSettings = settings_from(planner, **config.labelling_parameters)
        self.devices = devices or one_device()
        own, self.learned = widen(*read_run(start, allow), config.practice.observation)
        terrain = config.practice.terrain or own.terrain
        self.run_config = own.model_copy(update={"terrain": terrain})
        self.env = SteeringEnv(self.run_config.env, allow=allow)
        self.workers = ProcessWorkers(processes, PLANNER_MODULES)
        robot = self.run_config.env.robot
        self.settings, self.labelling = settings.for_robot(robot), labelling.for_robot(robot)
        self.judge = Judge(config.planner, self.settings, workers=self.workers, robot=robot)

    @cached_property
    def policy(self) -> Policy:
        """Return the policy to begin with."""
        return widen_policy(read_policy(f"{self._start}/{POLICY_FILE}"), self.env)

    @cached_property
    def ground(self) -> Ground:
        """Return the generated training terrain, made when first needed.

        Terrain files are left out: planners need surfaces, and files never judge.
        """
        terrain = self.run_config.terrain
        seeds = range(terrain.first_seed, terrain.first_seed + terrain.arenas)
        scenes = tuple(generate_arena(terrain.generator, seed).scene for seed in seeds)
        task = Steering(self.run_config.env, terrain.without_files(), allow=self.allow)
        return Ground(self.env, training_world(self.run_config, task), scenes)

    @property
    def identity(self) -> Identity:
        """Return the identity of the planner that the surrogates stand in for."""
        parameters = self.labelling.model_dump(mode="json")
        return Identity.of(self.config.planner, parameters, self.run_config.env)
