"""A round against a surrogate: the planner judges guide paths, a network learns, then PPO runs."""

import time
from pathlib import Path
from typing import Any

from jaxleas.distillation.folder import RoundFolder, read_done
from jaxleas.distillation.labelling import Collection, label_round
from jaxleas.distillation.practice import practice_config, practise, read_learned
from jaxleas.distillation.rounds import Practised, Say
from jaxleas.distillation.workplace import Workplace
from jaxleas.labels import Oracle
from jaxleas.surrogates import (
    Surrogate,
    SurrogateForesight,
    fit,
    read_labels,
    read_surrogate,
    require_fit,
    write_surrogate,
)
from jaxleas.training import Policy, read_policy


class AgainstSurrogate:
    """Practice against a surrogate that is fitted to the verdicts of all rounds so far."""

    def __init__(self, place: Workplace) -> None:
        self.place = place
        self._surrogate: Surrogate | None = None  # of the round before: chooses what to ask about

    def products(self, folder: RoundFolder) -> list[Path]:
        """Return the files of a round that are its result."""
        return [folder.policy, folder.surrogate]

    def practise(self, number: int, before: Practised, say: Say) -> Practised:
        """Return the result of the round; what is already in its folder is not done again."""
        place = self.place
        folder = place.folder.round(number)
        labelled = self._label(number, folder, before.policy, say)
        begun = time.perf_counter()
        surrogate = self._surrogate = self._fit(number, folder, say)
        seconds = {"labels": labelled["seconds"], "fit": round(time.perf_counter() - begun, 1)}
        if not folder.practised.is_file():
            say(f"round {number}: practice")
            config = practice_config(place.config, place.run_config)
            foresight = SurrogateForesight(surrogate, place.config.practice.threshold, queue=True)
            practise(folder, config, foresight, before.learned, place.devices, place.allow)
        seconds["practice"] = read_done(folder.practised, "seconds")["seconds"]
        learned = read_learned(folder.run)
        policy, report = read_policy(folder.policy), surrogate.report
        return Practised(policy, learned, labelled["guides"], seconds, report)

    def _label(self, number: int, folder: RoundFolder, policy: Policy, say: Say) -> dict[str, Any]:
        place = self.place
        if not folder.labelled.is_file():
            label_round(
                folder,
                place.ground,
                Collection(
                    policy, self._surrogate, place.config.collect, place.config.seed + number
                ),
                Oracle(place.config.planner, place.labelling, robot=place.run_config.env.robot),
                place.workers,
                lambda done, total: say(
                    f"round {number}: {done} of {total} guide paths judged", passing=True
                ),
            )
        return read_done(folder.labelled, "guides", "seconds")

    def _fit(self, number: int, folder: RoundFolder, say: Say) -> Surrogate:
        place = self.place
        if folder.surrogate.is_file():
            surrogate = read_surrogate(folder.surrogate)
            planner, parameters = place.config.planner, place.identity.parameters
            require_fit(surrogate, place.env.config, planner, parameters, str(folder.surrogate))
            return surrogate
        folders = [place.folder.round(each).labels for each in range(1, number + 1)]
        labels = read_labels(folders, [], place.run_config.terrain.resolution)
        surrogate = fit(
            labels.paths,
            labels.atlas,
            place.env,
            place.identity,
            place.config.fit,
            lambda epoch, loss: say(
                f"round {number}: fit, epoch {epoch}: {loss:.5f} nats", passing=True
            ),
        )
        write_surrogate(folder.surrogate, surrogate)
        return surrogate
