"""The distillation loop: label, fit, practise, judge; again, until the exact success stops rising.

The exact planner's verdict on held-out terrain is the only success that counts; the surrogate is
never more than an accelerator (systems: labels, surrogates, planner-aware training).
"""

import shutil
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from typing import Any

from jaxleas.distillation.config import DistillationConfig
from jaxleas.distillation.faithful import Faithful
from jaxleas.distillation.faithful_practice import practise_faithfully
from jaxleas.distillation.folder import DistillationFolder, RoundFolder, read_done
from jaxleas.distillation.judging import exact_success, judge_round, summary
from jaxleas.distillation.labelling import Ground, label_round
from jaxleas.distillation.practice import practice_config, practise, read_run
from jaxleas.distillation.rounds_file import VERSION
from jaxleas.distillation.widening import widen, widen_policy
from jaxleas.envs.steering.env import SteeringEnv
from jaxleas.files import atomic_path, write_json
from jaxleas.labels import Judge, PlannerSettings, ProcessWorkers
from jaxleas.labels.settings import settings_from
from jaxleas.surrogates import (
    Identity,
    Surrogate,
    fit,
    read_labels,
    read_surrogate,
    require_fit,
    write_surrogate,
)
from jaxleas.terrain.generator import generate_arena
from jaxleas.training.policy import SteeringPolicy, read_policy
from jaxleas.training.train_state import Learned
from jaxleas.training.worlds import training_world

POLICY_FILE = "policy.npz"
Say = Callable[[str], None]


@dataclass(frozen=True)
class RoundResult:
    """One row of the table.

    Attributes:
        round: its number; 0 is the policy begun with.
        success: mean exact success over all cells.
        cells: exact success of each cell.
        labels: guide paths judged in this round.
        seconds: spent on labels, fit, practice and judgement.
        surrogate: what its fit measured; None in round 0.
    """

    round: int
    success: float
    cells: dict[str, float]
    labels: int
    seconds: dict[str, float]
    surrogate: dict[str, Any] | None


class Distillation:
    """A distillation in its folder; `run` goes on from wherever it stands.

    Attributes:
        config: of the distillation.
        folder: it lives in.
        settings: of the planner, resolved.
    """

    def __init__(
        self, config: DistillationConfig, folder: DistillationFolder, start: str, processes: int
    ):
        """Prepare; nothing is computed yet.

        Args:
            config: of the distillation.
            folder: to work in.
            start: run folder of the policy to begin with.
            processes: that ask the planner.

        Raises:
            InputError: the planner's parameters cannot be used, or there is no such run.
        """
        self.config, self.folder = config, folder
        self.settings: PlannerSettings = settings_from(config.planner, **config.parameters)
        self.start = start
        self.run_config, self._learned = widen(*read_run(start), config.practice.observation)
        self.env = SteeringEnv(self.run_config.env)
        self.workers = ProcessWorkers(processes)
        self.judge = Judge(config.planner, self.settings, workers=self.workers)
        self._ground: Ground | None = None

    @property
    def ground(self) -> Ground:
        """The training terrain, made when first needed."""
        if self._ground is None:
            terrain = self.run_config.terrain
            seeds = range(terrain.first_seed, terrain.first_seed + terrain.arenas)
            scenes = tuple(generate_arena(terrain.generator, seed).scene for seed in seeds)
            self._ground = Ground(self.env, training_world(self.run_config), scenes)
        return self._ground

    @property
    def identity(self) -> Identity:
        """Whose stand-in the surrogates are."""
        env = self.run_config.env
        return Identity(
            planner=self.config.planner,
            parameters=self.settings.model_dump(mode="json"),
            robot=env.robot,
            observation=env.observation,
            height_low=env.height_low,
            height_high=env.height_high,
        )

    def _begin(self, say: Say) -> tuple[SteeringPolicy, Learned]:
        """Return the policy begun with, and what it has learned, practised without surrogate."""
        policy = widen_policy(read_policy(f"{self.start}/{POLICY_FILE}"), self.env)
        steps = self.config.practice.steps_before
        if not steps:
            return policy, self._learned
        folder = self.folder.round(0)
        if not folder.practised.is_file():
            say("round 0: practice without surrogate")
            config = practice_config(self.config, self.run_config, steps)
            practise(folder, config, None, self._learned, 0.0)
        return read_policy(folder.policy), read_run(folder.run)[1]

    def run(self, say: Say) -> list[RoundResult]:
        """Go on to the end; return the table of all rounds.

        Args:
            say: told, in words, what is done now.
        """
        try:
            policy, learned = self._begin(say)
            results = [self._judge(0, policy, say, {}, None, 0)]
            surrogate = None
            for number in range(1, self.config.rounds + 1):
                result, policy, learned, surrogate = self._round(
                    number, policy, learned, surrogate, say
                )
                results.append(result)
                self._keep(results)
                best = max(range(len(results)), key=lambda row: (results[row].success, -row))
                if number - best >= self.config.patience:
                    say(f"no rise of the exact success for {number - best} rounds: done")
                    break
            return results
        finally:
            self.workers.close()

    def _round(
        self,
        number: int,
        policy: SteeringPolicy,
        learned: Learned,
        surrogate: Surrogate | None,
        say: Say,
    ) -> tuple[RoundResult, SteeringPolicy, Learned, Surrogate | None]:
        """Return the result of one round, and what the next begins with."""
        folder = self.folder.round(number)
        if self.config.mode == "faithful":
            return self._faithful_round(number, folder, learned, say)
        labelled = self._label(number, folder, policy, surrogate, say)
        begun = time.perf_counter()
        surrogate = self._fit(number, folder, say)
        seconds = {"labels": labelled["seconds"], "fit": round(time.perf_counter() - begun, 1)}
        if not folder.practised.is_file():
            say(f"round {number}: practice")
            config = practice_config(self.config, self.run_config)
            practise(folder, config, surrogate, learned, self.config.practice.threshold)
        seconds["practice"] = read_done(folder.practised, "seconds")["seconds"]
        policy, (_, learned) = read_policy(folder.policy), read_run(folder.run)
        result = self._judge(number, policy, say, seconds, surrogate.report, labelled["guides"])
        return result, policy, learned, surrogate

    def _faithful_round(
        self, number: int, folder: RoundFolder, learned: Learned, say: Say
    ) -> tuple[RoundResult, SteeringPolicy, Learned, None]:
        """Return the same where the exact planner itself ends the episodes: no labels, no fit."""
        if not folder.practised.is_file():
            say(f"round {number}: practice, the exact planner in the loop")
            config = practice_config(self.config, self.run_config)
            ground = self.ground
            training = Faithful(
                config,
                self.config.faithful,
                SteeringEnv(config.env),
                ground.world,
                ground.scenes,
                self.judge,
            )
            practise_faithfully(folder, training, learned)
        seconds = {"practice": read_done(folder.practised, "seconds")["seconds"]}
        policy = read_policy(folder.policy)
        _, learned = read_run(folder.run)
        return self._judge(number, policy, say, seconds, None, 0), policy, learned, None

    def _label(
        self,
        number: int,
        folder: RoundFolder,
        policy: SteeringPolicy,
        surrogate: Surrogate | None,
        say: Say,
    ) -> dict[str, Any]:
        if not folder.labelled.is_file():
            label_round(
                folder,
                self.ground,
                policy,
                surrogate,
                self.config.planner,
                self.settings,
                self.config.collect,
                self.config.seed + number,
                self.workers,
                lambda done, total: say(f"round {number}: {done} of {total} guide paths judged"),
            )
        return read_done(folder.labelled, "guides", "seconds")

    def _fit(self, number: int, folder: RoundFolder, say: Say) -> Surrogate:
        if folder.surrogate.is_file():
            surrogate = read_surrogate(folder.surrogate)
            parameters = self.identity.parameters
            require_fit(
                surrogate, self.env.config, self.config.planner, parameters, str(folder.surrogate)
            )
            return surrogate
        folders = [self.folder.round(each).labels for each in range(1, number + 1)]
        labels = read_labels(folders, [], self.run_config.terrain.resolution)
        surrogate = fit(
            labels.walks,
            labels.atlas,
            self.env,
            self.identity,
            self.config.fit,
            lambda epoch, loss: say(f"round {number}: fit, epoch {epoch}: {loss:.5f} nats"),
        )
        write_surrogate(folder.surrogate, surrogate)
        return surrogate

    def _judge(
        self,
        number: int,
        policy: SteeringPolicy,
        say: Say,
        seconds: dict[str, float],
        report: dict[str, Any] | None,
        labels: int,
    ) -> RoundResult:
        begun = time.perf_counter()
        cells = judge_round(
            self.folder.round(number).judged,
            policy,
            f"leas_p2_{self.config.planner}" if number else "leas_p1",
            self.config.planner,
            self.judge,
            self.config.judge,
            lambda words: say(f"round {number}: the exact planner judges {words}"),
        )
        seconds = seconds | {"judgement": round(time.perf_counter() - begun, 1)}
        result = RoundResult(
            number, exact_success(cells), dict(summary(cells)), labels, seconds, report
        )
        say(f"round {number}: exact success {100 * result.success:.1f} %")
        return result

    def _keep(self, results: list[RoundResult]) -> None:
        """Write the table, and keep the best round's policy and surrogate at hand."""
        write_json(
            self.folder.table, {"version": VERSION, "rounds": [asdict(each) for each in results]}
        )
        best = max(results[1:], key=lambda result: (result.success, -result.round))
        source = self.folder.round(best.round)
        files = {source.policy: self.folder.policy}
        if self.config.mode == "surrogate":
            files[source.surrogate] = self.folder.surrogate
        for file, target in files.items():
            with atomic_path(target) as temporary:
                shutil.copyfile(file, temporary)
