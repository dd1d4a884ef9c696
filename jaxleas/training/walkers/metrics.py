"""The metrics that are logged for a roll-out."""

from typing import Any

from jaxleas.training.config import PpoConfig
from jaxleas.training.loss import Experience

Metrics = dict[str, Any]


def walk_metrics(
    ppo: PpoConfig, batch: Experience, reached: Any, measures: dict[str, Any], valid_starts: Any
) -> Metrics:
    """Return the metrics of a roll-out, from arrays of JAX or NumPy.

    Args:
        ppo: configuration of PPO: numbers of steps and robots.
        batch: experience of the roll-out.
        reached: whether a goal was reached [time, robots].
        measures: further measures of each step, by name.
        valid_starts: share of the drawn starts that are valid.
    """
    failed, cut = batch.terminated.sum(), batch.truncated.sum()
    return {
        "walk/reward": batch.reward.mean(),
        "walk/failures_per_1000_steps": 1000.0 * failed / ppo.batch,
        "walk/goals_per_1000_steps": 1000.0 * reached.sum() / ppo.batch,
        "walk/valid_starts": valid_starts,
        "walk/episodes": failed + cut,
        **{f"walk/{name}": each.mean() for name, each in measures.items()},
    }
