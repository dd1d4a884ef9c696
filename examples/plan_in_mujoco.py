"""Hand a contact plan to MuJoCo: stairs become geoms, and each foothold a site on them.

python examples/plan_in_mujoco.py stairs.xml
python -m mujoco.viewer --mjcf=stairs.xml
Needs the extra `physics`. MuJoCo itself measures how far each foothold is from the ground.
"""

import sys
from pathlib import Path
from xml.etree.ElementTree import SubElement, tostring

import numpy as np

from jaxleas.contacts import ContactPlan, ContactProblem, plan_mip, problem_from_guide
from jaxleas.envs.steering import SteeringEnv
from jaxleas.guide import leas, load_policy, paths, walk_queries
from jaxleas.physics import import_mujoco
from jaxleas.terrain import Scene, make_scenario, rasterise, scene_mjcf
from jaxleas.types import Query

QUERY = Query(position=(0.9, 0.0, 0.95), yaw=0.0, velocity=(0.0, 0.0, 0.0), goal=(5.0, 0.0))
COLOURS = {"LF": "0.9 0.2 0.2 1", "RF": "0.2 0.4 0.9 1"}


def plan_contacts(scene: Scene) -> tuple[ContactProblem, ContactPlan]:
    """Return the contact problem of a walk of the shipped policy, and its plan."""
    policy = load_policy("pretrained:leas_p1")
    env = SteeringEnv(policy.config)
    walked = walk_queries(env, leas(env, policy), rasterise(scene), [QUERY], steps=800)
    (guide,) = paths(walked, policy.config.limits.time_step)
    problem = problem_from_guide(guide, scene, "talos")
    return problem, plan_mip(problem)


def distances(file: str) -> np.ndarray:
    """Return how far each site is from the ground under it [m], by a ray from 5 cm above it."""
    mujoco = import_mujoco()
    model = mujoco.MjModel.from_xml_path(file)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    geom, up = np.zeros(1, np.int32), np.array([0.0, 0.0, 1.0])
    starts = data.site_xpos + 0.05 * up
    rays = [mujoco.mj_ray(model, data, at, -up, None, 1, -1, geom) for at in starts]
    return np.array(rays) - 0.05


if __name__ == "__main__":
    scene = make_scenario("stairs_up", 2_000_000).scene  # a seed that no training sees
    problem, plan = plan_contacts(scene)
    if plan.footholds is None:
        raise SystemExit(plan.reason)
    root = scene_mjcf(scene)
    (world,) = root.iter("worldbody")
    for index, (step, place) in enumerate(zip(problem.steps, plan.footholds, strict=True)):
        site = SubElement(world, "site", name=f"step_{index:02}", pos=" ".join(map(str, place)))
        site.attrib |= {"type": "box", "size": "0.1 0.06 0.004", "rgba": COLOURS[step.foot]}
        site.set("axisangle", f"0 0 1 {np.degrees(step.yaw)}")
    Path(sys.argv[1]).write_text(tostring(root, encoding="unicode"), encoding="utf-8")
    off = np.abs(distances(sys.argv[1]))
    print(f"{len(off)} footholds, at most {1000 * off.max():.1f} mm off the ground")
