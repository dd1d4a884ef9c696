"""A short plan by hand: the robot leans, steps with its left hind foot, and leans back."""

import numpy as np

from jaxleas.envs.gait_planning import Phases, QuadrupedConfig
from jaxleas.gaits import GaitPlan
from jaxleas.gaits.gait_plan import Program

HEIGHT = 0.45


def one_step(stride: float = 0.12, rise: float = 0.0, times: float = 0.8) -> GaitPlan:
    """Return a plan of two transitions.

    Args:
        stride: length of the step [m].
        rise: height of the ground where it ends [m].
        times: duration of each half of a transition [s].
    """
    robot = QuadrupedConfig()
    feet = np.tile(robot.nominal + np.array([0.0, 0.0, HEIGHT]), (3, 1, 1))
    feet[1:, 2] += [stride, 0.0, rise]
    com = np.array([[0.0, 0.0, HEIGHT], [0.09, -0.06, HEIGHT], [0.05, 0.0, HEIGHT]])
    phases = Phases(
        com=com.astype(np.float32),
        yaw=np.array([0.0, 0.03, 0.05], np.float32),
        velocity=np.zeros((3, 2), np.float32),
        feet=feet.astype(np.float32),
        support=np.array([0, 3, 0], np.int32),
    )
    program = Program(instants=4, least_margin=0.001, foot_clearance=0.05, edge_rise=0.01)
    return GaitPlan(
        "by hand", "reached", (0.05, 0.0), robot, program, phases, np.full((2, 2), times)
    )
