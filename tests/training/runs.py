"""Tiny trainings for tests."""

import os
import subprocess
import sys
from pathlib import Path

from benchmarks.tiny import tiny_training
from jaxleas.envs.steering import SteeringConfig, TerrainConfig
from jaxleas.training.config import RunConfig

SteeringRun = RunConfig[SteeringConfig, TerrainConfig]

ROOT = Path(__file__).resolve().parents[2]

TINY = tiny_training()


def tiny(**ppo) -> SteeringRun:
    return SteeringRun.model_validate(TINY | {"ppo": TINY["ppo"] | ppo})


def environment(devices: int) -> dict[str, str]:
    """Return the variables of a process that takes the processor for several devices."""
    forced = f"{os.environ['XLA_FLAGS']} --xla_force_host_platform_device_count={devices}"
    return os.environ | {"JAX_PLATFORMS": "cpu", "XLA_FLAGS": forced, "PYTHONPATH": str(ROOT)}


def start_training(*arguments: str, cache: Path) -> subprocess.Popen:
    """Start `python train.py ...` with a compile cache of its own: one start is slow, not all."""
    return subprocess.Popen(
        [sys.executable, "train.py", *arguments],
        cwd=ROOT,
        env=os.environ | {"JAX_COMPILATION_CACHE_DIR": str(cache), "CI": "true"},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        start_new_session=True,
    )
