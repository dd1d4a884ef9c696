"""Timings of Stable-Baselines3 on the steering task, in a separate Python.

python -m benchmarks.rivals.sb3 TASK.npz OUT.json [--runs N] [--measure NAME ...]
"""

import argparse
import json
import resource
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import torch  # type: ignore[import-not-found]
from stable_baselines3 import PPO  # type: ignore[import-not-found]
from stable_baselines3.common.callbacks import BaseCallback  # type: ignore[import-not-found]
from stable_baselines3.common.vec_env import (  # type: ignore[import-not-found]
    DummyVecEnv,
    SubprocVecEnv,
    VecEnv,
)

from benchmarks.rivals.adapters import BatchedSteering, SingleSteering
from benchmarks.rivals.steering_numpy import SteeringBatch
from benchmarks.rivals.task import Task, read_task

SIX = 6  # parallel agents M (T table 3.1)
BATCH = 4096 * SIX  # steps between two updates (T table 3.1)
TRIAL = 8  # an 8th of a batch is enough to find the faster way
BATCHED = 96  # robots of the batched environment: 256 steps each
THREADS = torch.get_num_threads()
ENV_SIZES = (96, 1024)  # robots for the environment alone: the better size counts


class _Clock(BaseCallback):
    """A callback that records the start of each roll-out; one update lies between two starts."""

    def __init__(self) -> None:
        super().__init__()
        self.begins: list[float] = []

    def _on_rollout_start(self) -> None:
        self.begins.append(time.perf_counter())

    def _on_step(self) -> bool:
        return True


def make_ppo(envs: VecEnv, batch: int = BATCH) -> PPO:
    """Return PPO with the thesis's hyperparameters (T table 3.1, sec. 3.4)."""
    return PPO(
        "MlpPolicy",
        envs,
        n_steps=batch // envs.num_envs,
        batch_size=256,
        n_epochs=10,
        learning_rate=lambda left: 1e-5 + (5e-4 - 1e-5) * left,
        gamma=0.97,
        clip_range=0.2,
        policy_kwargs={"net_arch": {"pi": [128, 64, 32], "vf": [128, 64, 32]}},
        device="cpu",
        seed=0,
    )


def best_train_rates(ways: list[Callable[[], VecEnv]], runs: int) -> list[float]:
    """Return `train_rates` of the fastest way, with one thread or as many as torch uses.

    A short trial of each way finds the fastest one.
    """
    trials = []
    for threads in {1, THREADS}:
        torch.set_num_threads(threads)
        trials += [(train_rates(way(), 1, BATCH // TRIAL)[0], threads, way) for way in ways]
    _, threads, way = max(trials, key=lambda trial: trial[0])
    torch.set_num_threads(threads)
    return train_rates(way(), runs, BATCH)


def train_rates(envs: VecEnv, runs: int, batch: int) -> list[float]:
    """Return the training steps per second, one value per update, without the first."""
    clock = _Clock()
    make_ppo(envs, batch).learn((runs + 1) * batch, callback=clock)
    ends = [*clock.begins[1:], time.perf_counter()]
    envs.close()
    return [batch / (end - begin) for begin, end in zip(clock.begins, ends, strict=True)][1:]


def env_rates(task: Task, runs: int) -> list[float]:
    """Return the steps per second of the environment alone, random actions, at its best size."""
    return max((_env_rates(task, count, runs) for count in ENV_SIZES), key=np.median)


def _env_rates(task: Task, count: int, runs: int) -> list[float]:
    batch = SteeringBatch(task, count)
    rates, steps = [], max(20, 40_000 // count)
    for run in range(runs + 1):
        begin = time.perf_counter()
        for _ in range(steps):
            outcome = batch.step(batch.random.uniform(-1, 1, (count, 4)).astype(np.float32))
            done = outcome.terminated | outcome.truncated
            if done.any():
                batch.restart(done)
                outcome.observation[done] = batch.observe()[done]
        if run:
            rates.append(count * steps / (time.perf_counter() - begin))
    return rates


def latencies(task: Task, runs: int, count: int) -> list[float]:
    """Return the duration of `predict` [us], with one thread or many, whichever is faster."""
    found = []
    for threads in {1, THREADS}:
        torch.set_num_threads(threads)
        found.append(_latencies(task, runs, count))
    return min(found, key=np.median)


def _latencies(task: Task, runs: int, count: int) -> list[float]:
    envs = BatchedSteering(task, count)
    model = make_ppo(BatchedSteering(task, BATCHED))
    observation = envs.reset()
    values = []
    for run in range(runs + 1):
        begin, calls = time.perf_counter(), 0
        while time.perf_counter() - begin < 0.3:
            model.predict(observation, deterministic=True)
            calls += 1
        if run:
            values.append(1e6 * (time.perf_counter() - begin) / calls)
    return values


def peak_memory(task: Task) -> list[float]:
    """Return the peak memory of this process after an update [MiB]."""
    train_rates(BatchedSteering(task, BATCHED), 1, BATCH)
    return [resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0]


def six_environments(task: Task, runs: int) -> list[float]:
    """Return the rate of six environments in one process or in six, whichever is faster."""
    makers = [partial(SingleSteering, task, seed) for seed in range(SIX)]
    ways: list[Callable[[], VecEnv]] = [
        lambda: DummyVecEnv(makers),
        lambda: SubprocVecEnv(makers),
    ]
    return best_train_rates(ways, runs)


MEASURES: dict[str, Callable[[Task, int], list[float]]] = {
    "memory": lambda task, runs: peak_memory(task),  # first: memory only grows
    "env": env_rates,
    "batched": lambda task, runs: best_train_rates([lambda: BatchedSteering(task, BATCHED)], runs),
    "six": six_environments,
    "latency_1": lambda task, runs: latencies(task, runs, 1),
    "latency_1024": lambda task, runs: latencies(task, runs, 1024),
}


def main() -> None:
    """Measure what was asked for and write it as one JSON object of lists."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("task", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--measure", nargs="+", choices=MEASURES, default=list(MEASURES))
    given = parser.parse_args()
    task = read_task(given.task)
    results: dict[str, Any] = {}
    for name, measure in MEASURES.items():
        if name in given.measure:
            results[name] = measure(task, given.runs)
    given.out.write_text(json.dumps(results), encoding="utf-8")


if __name__ == "__main__":
    main()
