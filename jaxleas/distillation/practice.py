"""A round's practice: the policy continues to learn while the surrogate ends its episodes."""

import logging
import time
from collections.abc import Collection
from pathlib import Path

import jax

from jaxleas.conditions import Foresight, harmless, permission
from jaxleas.configuration import to_yaml
from jaxleas.distillation.config import DistillationConfig, SteeringRun
from jaxleas.distillation.folder import RoundFolder
from jaxleas.distillation.loading import load_steering_run
from jaxleas.envs.steering import Steering
from jaxleas.files import write_json
from jaxleas.runs import Checkpoints, RunFolder
from jaxleas.training import (
    Devices,
    Learned,
    initial_normaliser,
    make_networks,
    policy_of,
    train_task,
    write_policy,
)

_LOG = logging.getLogger("jaxleas")


def practice_config(
    config: DistillationConfig, start: SteeringRun, steps: int | None = None
) -> SteeringRun:
    """Return the configuration of a round's run.

    The networks are those of the policy begun with. Falling costs as much from the first step on as
    it did at the end of the first training: this policy no longer needs to explore boldly.

    Args:
        config: configuration of the distillation.
        start: configuration of the run begun with.
        steps: number of environment steps; by default a round's.
    """
    changes = {
        "steps": steps or config.practice.steps,
        "learning_rate": config.practice.learning_rate,
        "final_learning_rate": config.practice.final_learning_rate,
    }
    ppo = start.ppo.model_copy(update=changes)
    final = {"failure": start.env.reward.final_failure}
    reward = start.env.reward.model_copy(update=final | config.practice.reward)
    if "failure" in config.practice.reward:
        reward = reward.model_copy(update={"final_failure": reward.failure})
    speed = config.practice.desired_speed or start.env.desired_speed
    env = start.env.model_copy(update={"reward": reward, "desired_speed": speed})
    return start.model_copy(update={"ppo": ppo, "env": env})


def practise(
    folder: RoundFolder,
    config: SteeringRun,
    foresight: Foresight | None,
    learned: Learned,
    devices: Devices,
    allow: Collection[str] = (),
) -> None:
    """Train in the round's run folder, and resume an interrupted practice.

    The policy is the average that the run ends with. (The most successful one on the way, which a
    run folder keeps, is chosen by reachability, and here it is the planner that counts.)

    Args:
        folder: folder of the round.
        config: configuration of the run.
        foresight: foresight that ends episodes, in addition to reachability and collision, if any.
        learned: networks to begin with.
        devices: devices that share the practice.
        allow: user's own code that may be run, as MODULE:CLASS: conditions.
    """
    begun = time.perf_counter()
    if (folder.run / "config.yaml").is_file():
        run = RunFolder.open(folder.run, writing=True, needs_checkpoint=False)
    else:
        run = RunFolder.create(folder.run, to_yaml(config), ["jaxleas", "distill"])
    with run:
        task = Steering(config.env, config.terrain, foresight=foresight, allow=allow)
        train_task(config, task, run, devices, learned)
    conclude(folder, config, time.perf_counter() - begun)


def conclude(folder: RoundFolder, config: SteeringRun, seconds: float) -> None:
    """Keep the average that a practice's run ended with as the round's policy.

    Args:
        folder: folder of the round.
        config: configuration of the run.
        seconds: duration of the practice [s].
    """
    after = read_learned(folder.run)
    networks = make_networks(config.network, config.env.signature())
    policy = policy_of(networks, config.env, after.normaliser, after.averaged)
    write_policy(folder.policy, policy)
    steps = config.ppo.updates * config.ppo.batch
    write_json(folder.practised, {"steps": steps, "seconds": round(seconds, 1)})


def read_run(path: str | Path, allow: Collection[str] = ()) -> tuple[SteeringRun, Learned]:
    """Return the configuration of a run and what it has learned by its newest checkpoint.

    Conditions that are code which may not be run, or a surrogate's file, give way to R* and C, with
    a warning: a distillation has a surrogate of its own.

    Args:
        path: run folder.
        allow: user's own code that may be run, as MODULE:CLASS: conditions.

    Raises:
        InputError: the path is not a run folder, or has no checkpoint that can be read.
    """
    run = RunFolder.open(path)
    config = load_steering_run(run.config)
    learned = _learned(run, config)
    if not harmless(config.env.conditions, allow):
        _LOG.warning(
            "%s: conditions other than the built-in ones give way to R* and C%s",
            path,
            permission(config.env.conditions, allow),
        )
        env = config.env.under_standard_conditions()
        config = config.model_copy(update={"env": env})
    return config, learned


def read_learned(path: str | Path) -> Learned:
    """Return what a run has learned by its newest checkpoint.

    Raises:
        InputError: the path is not a run folder, or has no checkpoint that can be read.
    """
    run = RunFolder.open(path)
    return _learned(run, load_steering_run(run.config))


def _learned(run: RunFolder, config: SteeringRun) -> Learned:
    like = jax.eval_shape(lambda: _fresh(config))
    return Checkpoints(run.checkpoints).latest(like, partial=True)[1]


def _fresh(config: SteeringRun) -> Learned:
    signature = config.env.signature()
    params = make_networks(config.network, signature).init(jax.random.key(0), jax.random.key(0))
    return Learned(params, params.policy, initial_normaliser(config.network, signature))
