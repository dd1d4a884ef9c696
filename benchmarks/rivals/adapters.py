"""The NumPy task for Stable-Baselines3: as a batch, or as one Gymnasium environment."""

from typing import Any

import gymnasium  # type: ignore[import-not-found]
import numpy as np
from stable_baselines3.common.vec_env import VecEnv  # type: ignore[import-not-found]

from benchmarks.rivals.steering_numpy import SteeringBatch
from benchmarks.rivals.task import Task


def spaces(task: Task, size: int) -> tuple[Any, Any]:
    """Return the spaces of (scaled) observations and of actions."""
    del task
    return (
        gymnasium.spaces.Box(-10.0, 10.0, (size,), np.float32),
        gymnasium.spaces.Box(-1.0, 1.0, (4,), np.float32),
    )


def scaling(task: Task, size: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the offset and divisor that bring observations to [-1, 1]."""
    constants = task.constants
    low, high = constants["height_low"], constants["height_high"]
    centre = np.full(size, (low + high) / 2, np.float32)
    half = np.full(size, (high - low) / 2, np.float32)
    centre[:4], half[:3], half[3] = 0.0, constants["max_speed"], np.pi
    return centre, half


class BatchedSteering(VecEnv):
    """All robots in one NumPy batch: the fastest way to feed Stable-Baselines3."""

    def __init__(self, task: Task, count: int, seed: int = 0) -> None:
        self.batch = SteeringBatch(task, count, seed)
        self.centre, self.half = scaling(task, self.batch.size)
        self._actions = np.zeros((count, 4), np.float32)
        self.render_mode = None
        super().__init__(count, *spaces(task, self.batch.size))

    def reset(self) -> np.ndarray:
        self.batch.restart(np.ones(self.num_envs, bool))
        return self._scaled(self.batch.observe())

    def step_async(self, actions: np.ndarray) -> None:
        self._actions = actions

    def step_wait(self) -> Any:
        outcome = self.batch.step(self._actions)
        observation = self._scaled(outcome.observation)
        done = outcome.terminated | outcome.truncated
        infos: list[dict[str, Any]] = [{} for _ in range(self.num_envs)]
        if done.any():
            for index in np.flatnonzero(done):
                infos[index]["terminal_observation"] = observation[index].copy()
                infos[index]["TimeLimit.truncated"] = bool(outcome.truncated[index])
            self.batch.restart(done)
            observation[done] = self._scaled(self.batch.observe())[done]
        return observation, outcome.reward.astype(np.float32), done, infos

    def _scaled(self, observation: np.ndarray) -> np.ndarray:
        return (observation - self.centre) / self.half

    def close(self) -> None:
        pass

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        return [getattr(self, attr_name, None)] * self.num_envs

    def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:
        raise NotImplementedError

    def env_method(self, method_name: str, *args: Any, indices: Any = None, **kwargs: Any) -> Any:
        raise NotImplementedError

    def env_is_wrapped(self, wrapper_class: Any, indices: Any = None) -> list[bool]:
        return [False] * self.num_envs


class SingleSteering(gymnasium.Env):
    """One robot, in the usual form; the thesis used six of them."""

    def __init__(self, task: Task, seed: int = 0) -> None:
        self.batch = SteeringBatch(task, 1, seed)
        self.centre, self.half = scaling(task, self.batch.size)
        self.observation_space, self.action_space = spaces(task, self.batch.size)

    def reset(self, *, seed: int | None = None, options: Any = None) -> Any:
        super().reset(seed=seed)
        self.batch.restart(np.ones(1, bool))
        return self._scaled(self.batch.observe()), {}

    def step(self, action: np.ndarray) -> Any:
        outcome = self.batch.step(action[None])
        ended = bool(outcome.terminated[0]), bool(outcome.truncated[0])
        return self._scaled(outcome.observation), float(outcome.reward[0]), *ended, {}

    def _scaled(self, observation: np.ndarray) -> np.ndarray:
        return ((observation - self.centre) / self.half)[0]
