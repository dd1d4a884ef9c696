"""Contact problems and plans, robots."""

import json
from pathlib import Path

import numpy as np

from tests.robustness.hostile_files import mutations as m
from tests.robustness.hostile_files.kinds import Kind, kind_of

URDF = """<robot name="toy"><link name="a"/><link name="b"/><link name="c"/>
  <joint name="hip" type="revolute"><parent link="a"/><child link="b"/>
    <origin xyz="0 0 0.5" rpy="0.1 0 0"/><axis xyz="0 1 0"/><limit lower="-1" upper="1"/></joint>
  <joint name="sole" type="fixed"><parent link="b"/><child link="c"/></joint></robot>"""


def contact_kinds(folder: Path) -> list[Kind]:
    from jaxleas.contacts.infeasibility import InfeasibilityProof, ProofSet
    from jaxleas.contacts.plan import ContactPlan, read_plan, write_plan
    from jaxleas.contacts.posture import Posture
    from jaxleas.contacts.problem import FootPose
    from jaxleas.contacts.problem_file import read_problem, write_problem
    from jaxleas.robots.files import read_robot
    from jaxleas.robots.urdf import read_chain
    from jaxleas.viewer.clips import read_plan_clip

    surfaces = {"floor": [[0, -1, 0], [4, -1, 0], [4, 1, 0], [0, 1, 0]]}
    problem = {
        "version": 1,
        "robot": "talos",
        "model": "two_com",
        "surfaces": surfaces,
        "initial": {
            "LF": {"position": [1, 0.1, 0], "yaw": 0.0},
            "RF": {"position": [1, -0.1, 0], "yaw": 0.0},
        },
        "phases": [
            {"foot": "RF", "yaw": 0.0, "candidates": ["floor"], "root": [1.2, 0, 0.95]},
            {"foot": "LF", "yaw": 0.0, "candidates": ["floor"], "root": [1.4, 0, 0.95]},
        ],
    }
    (folder / "raw_problem.json").write_text(json.dumps(problem))
    write_problem(folder / "problem.json", read_problem(folder / "raw_problem.json"))
    feet = {foot: FootPose(np.array([1.0, 0.1, 0.0]), 0.0) for foot in ("LF", "RF")}
    posture = Posture(0, "start", None, feet, {"LF": "floor", "RF": "floor"}, np.zeros(3))
    plan = ContactPlan(
        planner="mip",
        feasible=True,
        status="feasible",
        surfaces=("floor", "floor"),
        footholds=np.array([[1.3, -0.1, 0], [1.5, 0.1, 0]]),
        com=np.zeros((2, 2, 3)),
        max_violation=0.0,
        robustness=(1.0,),
        postures=(posture,),
        proof=InfeasibilityProof((ProofSet(0, "", np.zeros((1, 3)), {"floor": 0}),)),
    )
    write_plan(folder / "plan.json", plan)
    asked = folder / "problem.json"
    data = Path(__file__).resolve().parents[3] / "jaxleas" / "robots" / "data"

    (folder / "toy.urdf").write_text(URDF)

    def plan_read(path: Path) -> None:
        read_plan(path)
        read_plan_clip(path, path.with_name("problem.json"))

    return [
        kind_of("contact problem", folder / "problem.json", read_problem, m.mutate_json),
        kind_of("contact plan", folder / "plan.json", plan_read, m.mutate_json, asked),
        kind_of("robot", data / "talos.json", read_robot, m.mutate_json),
        kind_of("robot with numeric legs", data / "g1.json", read_robot, m.mutate_json),
        kind_of(
            "URDF", folder / "toy.urdf", lambda path: read_chain(path, "a", "c"), m.mutate_text
        ),
    ]
