"""Steps of gait planning, every program solved: `python -m benchmarks.transitions.steps [POLICY]`.

Without a policy actions are random, near the middle of their ranges. Times are processor time, so
that other processes on the machine do not count: per core, divided by the steps.
"""

import sys
import time
from collections.abc import Callable
from typing import Any

import numpy as np

from jaxleas.envs import HostPool
from jaxleas.envs.gait_planning import (
    GaitPlanning,
    GaitPlanningConfig,
    GaitWorldsConfig,
    candidate_of,
    command_of,
)
from jaxleas.training import read_policy

ROBOTS, STEPS, SPREAD = 2048, 8, 0.15
FIELDS = 60

Act = Callable[[Any, np.random.Generator], np.ndarray]


def random_action(seen: Any, generator: np.random.Generator) -> np.ndarray:
    """Return actions near the middle of their ranges, and any support."""
    count = len(seen["attitude"])
    numbers = np.tanh(SPREAD * generator.normal(size=(count, 15)))
    return np.concatenate([numbers, generator.integers(5, size=(count, 1))], axis=1)


def action_of(file: str) -> Act:
    """Return the actions of a policy."""
    policy = read_policy(file, of=GaitPlanningConfig)

    def act(seen: Any, generator: np.random.Generator) -> np.ndarray:
        del generator
        return np.asarray(policy.action(seen))

    return act


def main(arguments: list[str]) -> None:
    """Measure and print."""
    task = GaitPlanning(GaitPlanningConfig(), GaitWorldsConfig())
    config, generator = task.config, np.random.default_rng(0)
    act = action_of(arguments[0]) if arguments else random_action
    ground = task.make_world(range(FIELDS), False)
    pool = HostPool.of(task.draw_starts(ground, generator, 4 * ROBOTS))
    state, _ = pool.take(pool.draw_picks(generator, (ROBOTS,)))
    weights = {f"reward.{name}": value for name, value in config.reward.model_dump().items()}
    whole = solving = accepted = 0.0
    everyone = np.ones(ROBOTS, bool)
    for step in range(STEPS + 1):
        seen = task.look(ground, state)
        action = act(seen, generator)
        begin = time.process_time()
        command = command_of(config, ground, state, action)
        candidate = candidate_of(config, ground, state, command)
        task.decide(state.phase, candidate, command.times, everyone)
        solved = time.process_time()
        state, result = task.advance(ground, weights, state, action, ())
        end = time.process_time()
        picks = pool.draw_picks(generator, (ROBOTS,))
        over = np.asarray(result.terminated) | np.asarray(result.truncated)
        state = pool.restart_where(over, state, picks)
        if step:  # the first loads the compiled loops
            solving += solved - begin
            whole += end - begin
            accepted += 1.0 - result.terminated.mean()
    count = ROBOTS * STEPS
    print(f"every program solved: {1e6 * solving / count:.0f} us a step, {count / solving:.0f}/s")
    rest = whole - solving
    print(f"as trained: {1e6 * rest / count:.0f} us a step, {count / rest:.0f}/s")
    print(f"accepted: {100.0 * accepted / STEPS:.1f} %")


if __name__ == "__main__":
    main(sys.argv[1:])
