"""Take a GridMap in, as a mapping robot writes it: find its surfaces, walk, and plan footholds.

python examples/footholds_on_grid_map.py map.mcap --start 0.7 0 --goal 4 0 --out footholds.csv

The bag (.bag, .mcap, .db3, or the folder of a ROS 2 bag) is read without ROS; extra: `maps`.
Each row of the table is a step: its foot, the surface that it lands on, and the place [m].
"""

import argparse
import csv

import numpy as np

from jaxleas.contacts import plan_mip, problem_from_guide
from jaxleas.envs.steering import SteeringEnv
from jaxleas.guide import leas, load_policy, paths, walk_queries
from jaxleas.terrain import READING, import_terrain, load_scene
from jaxleas.types import Query

if __name__ == "__main__":
    parser = argparse.ArgumentParser(description="Plan footholds over a GridMap.")
    parser.add_argument("bag", help="bag with one GridMap topic; its layer elevation is read")
    parser.add_argument("--start", type=float, nargs=2, required=True, metavar=("X", "Y"))
    parser.add_argument("--goal", type=float, nargs=2, required=True, metavar=("X", "Y"))
    parser.add_argument("--out", required=True, help="table of footholds, .csv")
    given = parser.parse_args()

    terrain = import_terrain(given.bag)  # heights [row = y, column = x]
    scene = load_scene(given.bag, READING)  # planar surfaces found in them
    policy = load_policy("pretrained:leas_p1")
    env = SteeringEnv(policy.config)
    (ground,) = terrain.height_at(np.array([given.start]))
    start = (*given.start, float(ground) + env.robot.walking_height)
    query = Query(start, yaw=0.0, velocity=(0.0, 0.0, 0.0), goal=tuple(given.goal))
    walked = walk_queries(env, leas(env, policy), terrain, [query], steps=800)
    (guide,) = paths(walked, policy.config.limits.time_step)
    problem = problem_from_guide(guide, scene, "talos")
    plan = plan_mip(problem)
    if plan.footholds is None:
        raise SystemExit(plan.reason)
    with open(given.out, "w", newline="", encoding="utf-8") as file:
        table = csv.writer(file)
        table.writerow(["foot", "surface", "x", "y", "z"])
        for step, surface, place in zip(problem.steps, plan.surfaces, plan.footholds, strict=True):
            table.writerow([step.foot, surface, *(f"{value:.3f}" for value in place)])
    reached = "reached" if walked.reached[0] else "did not reach"
    print(f"{reached} the goal: {len(plan.surfaces)} footholds on {len(scene.surfaces)} surfaces")
