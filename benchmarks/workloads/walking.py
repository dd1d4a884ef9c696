"""Speed of a walking controller in physics: controller and MuJoCo together."""

import time

import numpy as np

from benchmarks.context import Context
from benchmarks.measurements import Figure, Metric
from benchmarks.workloads.workload import Workload
from jaxleas.controllers import DEFAULT_CONTROLLER, TICK, Walk, find_controller
from jaxleas.physics import DEFAULT_BODY, Variation, load_body, make_physics, standing

ROBOTS = 64
TICKS = 250
RUNS = 3
NOISE = 2.0
"""As footsteps are collected: each robot is another one, and torques have noise [Nm]."""


def walking_rates(robots: int = ROBOTS, ticks: int = TICKS, runs: int = RUNS) -> list[float]:
    """Return the robot time walked per processor time of all threads, of several runs.

    Args:
        robots: number of robots that walk at once.
        ticks: number of ticks of a run.
        runs: number of runs, after one that is not measured.
    """
    body, rng = load_body(DEFAULT_BODY), np.random.default_rng(0)
    varied = Variation(rng.uniform(0.5, 1.0, robots), rng.uniform(0.9, 1.1, robots))
    controller = find_controller(DEFAULT_CONTROLLER, body)
    walk = Walk(make_physics(body, robots, variation=varied), controller, NOISE)
    walking = walk.begin(standing(body, np.zeros((robots, 3))))
    most = np.array(controller.identity.max_speeds)
    commands = rng.uniform(-0.9, 0.9, (robots, 3)) * most * np.eye(3)[np.arange(robots) % 3]
    commands[:, 0] = np.abs(commands[:, 0])
    rates = []
    for _ in range(runs + 1):
        begun = time.process_time()
        for _ in range(ticks):
            walking = walk.tick(walking, commands, rng).walking
        rates.append(robots * ticks * TICK / (time.process_time() - begun))
    return rates[1:]


def _measure(context: Context) -> dict[str, Figure]:
    del context
    return {WALKED: Figure(walking_rates())}


WALKED = f"walk_{ROBOTS}"
WALKING = Workload((Metric(WALKED, "robot s per thread s", tolerance=0.2),), _measure)
