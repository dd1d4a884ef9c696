"""Train on a mesh of your own, then walk over it: half of the starts fall on the mesh.

python examples/train_on_mesh.py hall.stl --run-dir runs/hall --start 0.5 1 --goal 4 1

Further options are fields of the configuration, such as --ppo.steps 3_000_000. A mesh is in metres
with z up; `jaxleas train --help` and docs/files.md say how to state others.
"""

import argparse
from pathlib import Path

import numpy as np

from jaxleas.envs.steering import SteeringEnv
from jaxleas.guide import leas, load_policy, paths, walk_queries
from jaxleas.terrain import import_terrain
from jaxleas.train_command import train
from jaxleas.types import Query

if __name__ == "__main__":
    parser = argparse.ArgumentParser(description="Train on a mesh, and walk over it.")
    parser.add_argument("mesh", help="mesh, .stl, .obj or .ply")
    parser.add_argument("--run-dir", type=Path, required=True, help="folder for the run")
    parser.add_argument("--start", type=float, nargs=2, required=True, metavar=("X", "Y"))
    parser.add_argument("--goal", type=float, nargs=2, required=True, metavar=("X", "Y"))
    given, fields = parser.parse_known_args()

    mesh = ("--terrain.files", f"[{given.mesh}]", "--terrain.files_share", "0.5")
    train(Path("leas_p1"), *mesh, *fields, run_dir=given.run_dir)

    policy = load_policy(given.run_dir)
    env = SteeringEnv(policy.config)
    terrain = import_terrain(given.mesh)
    (ground,) = terrain.height_at(np.array([given.start]))
    start = (*given.start, float(ground) + env.robot.walking_height)
    query = Query(start, yaw=0.0, velocity=(0.0, 0.0, 0.0), goal=tuple(given.goal))
    walked = walk_queries(env, leas(env, policy), terrain, [query], steps=800)
    (path,) = paths(walked, policy.config.limits.time_step)
    reached = "reached" if walked.reached[0] else "did not reach"
    print(f"{reached} the goal on {given.mesh} in {path.length:.2f} m")
