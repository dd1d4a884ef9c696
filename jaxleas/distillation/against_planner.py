"""A round against the exact planner itself, which ends the episodes: no labels, no fit."""

from pathlib import Path

from jaxleas.distillation.faithful import Faithful
from jaxleas.distillation.faithful_practice import practise_faithfully
from jaxleas.distillation.folder import RoundFolder, read_done
from jaxleas.distillation.practice import practice_config, read_learned
from jaxleas.distillation.rounds import Practised, Say
from jaxleas.distillation.workplace import Workplace
from jaxleas.envs.steering import Steering
from jaxleas.training import read_policy


class AgainstPlanner:
    """Practice with the exact planner in the loop, the thesis's own way."""

    def __init__(self, place: Workplace) -> None:
        self.place = place

    def products(self, folder: RoundFolder) -> list[Path]:
        """Return the files of a round that are its result."""
        return [folder.policy]

    def practise(self, number: int, before: Practised, say: Say) -> Practised:
        """Return the result of the round; what is already in its folder is not done again."""
        place = self.place
        folder = place.folder.round(number)
        if not folder.practised.is_file():
            say(f"round {number}: practice, the exact planner in the loop")
            config = practice_config(place.config, place.run_config)
            task = Steering(config.env, config.terrain, allow=place.allow)
            faithful, ground = place.config.faithful, place.ground
            training = Faithful(config, faithful, task, ground.world, ground.scenes, place.judge)
            practise_faithfully(folder, training, before.learned)
        seconds = {"practice": read_done(folder.practised, "seconds")["seconds"]}
        return Practised(read_policy(folder.policy), read_learned(folder.run), seconds=seconds)
