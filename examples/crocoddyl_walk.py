"""Walk a contact plan with Crocoddyl: phases of `jaxleas contacts export`, nothing else of jaxleas.

    jaxleas contacts export plan.json problem.json --guide guide.npz --out phases.json
    python examples/crocoddyl_walk.py phases.json --robot talos

It needs `pip install crocoddyl example-robot-data`. Each phase becomes knots with its contacts; an
effector that moves follows a smooth swing to the place where it lands, and stands still there.
"""

import argparse
import json
from pathlib import Path
from typing import Any

import crocoddyl  # pyright: ignore[reportMissingImports]
import numpy as np
import pinocchio  # pyright: ignore[reportMissingImports]

STEP_HEIGHT = 0.1
"""Height of a swing above the higher of both contacts [m]."""
LEAST_KNOTS = 2
SWING, LANDING = 1e5, 1e6
"""Weights of an effector's place on its way, and where it lands."""


def placement(pose: dict[str, Any]) -> pinocchio.SE3:
    """Return a pose of the file, whose quaternion is (w, x, y, z)."""
    turn = pinocchio.Quaternion(*pose["quaternion"]).normalized()
    return pinocchio.SE3(turn.matrix(), np.array(pose["position"]))


def add_effectors(model: Any, effectors: dict[str, Any]) -> dict[str, int]:
    """Add a frame in the middle of each sole, its z away from the ground; return their numbers."""
    frames = {}
    for name, each in effectors.items():
        link = model.frames[model.getFrameId(each["link"])]
        inside = link.placement * placement(each["frame"])
        frame = pinocchio.Frame(
            f"sole_{name}", link.parentJoint, inside, pinocchio.FrameType.OP_FRAME
        )
        frames[name] = model.addFrame(frame)
    return frames


def swing(start: pinocchio.SE3, end: pinocchio.SE3, share: float) -> pinocchio.SE3:
    """Return the pose of an effector after a share of its swing, 0 to 1."""
    smooth = share**3 * (10.0 - 15.0 * share + 6.0 * share**2)
    pose = pinocchio.SE3.Interpolate(start, end, smooth)
    way = smooth * (end.translation - start.translation)
    lift = STEP_HEIGHT + 0.5 * abs(end.translation[2] - start.translation[2])
    pose.translation = start.translation + way
    pose.translation[2] += lift * 16.0 * (share * (1.0 - share)) ** 2
    return pose


class Walk:
    """Makes a shooting problem of the phases of a contact plan."""

    def __init__(
        self, model: Any, usual: np.ndarray, content: dict[str, Any], interval: float
    ) -> None:
        self.model, self.content, self.interval = model, content, interval
        self.frames = add_effectors(model, content["effectors"])
        self.state = crocoddyl.StateMultibody(model)
        self.actuation = crocoddyl.ActuationModelFloatingBase(self.state)
        self.start = np.concatenate([self._standing(usual), np.zeros(model.nv)])

    def problem(self) -> Any:
        """Return the shooting problem of all phases."""
        knots, com = [], self._com()
        latest = dict(self.content["phases"][0]["contacts"])
        for phase in self.content["phases"]:
            count = max(LEAST_KNOTS, round(phase["duration"] / self.interval))
            landing = phase["landing"]
            middle = np.mean([each["position"] for each in phase["contacts"].values()], axis=0)
            for knot in range(count):
                target = None
                if landing is not None and landing["effector"] in latest:
                    start = placement(latest[landing["effector"]])
                    target = (
                        landing["effector"],
                        swing(start, placement(landing), (knot + 1) / count),
                    )
                weight = LANDING if knot == count - 1 else SWING
                knots.append(self._knot(phase["contacts"], middle + com, target, weight))
            if landing is not None:
                latest[landing["effector"]] = landing
        return crocoddyl.ShootingProblem(self.start, knots, knots[-1])

    def _standing(self, configuration: np.ndarray) -> np.ndarray:
        """Return a usual configuration of the robot, moved onto the plan's first contacts."""
        model, configuration = self.model, configuration.copy()
        data = model.createData()
        pinocchio.framesForwardKinematics(model, data, configuration)
        first = self.content["phases"][0]["contacts"]
        names = [each for each in self.frames if each in first]
        is_at = np.mean([data.oMf[self.frames[each]].translation for each in names], axis=0)
        wanted = np.mean([first[each]["position"] for each in names], axis=0)
        yaw = float(np.mean([np.arctan2(*placement(first[n]).rotation[1::-1, 0]) for n in names]))
        turn = pinocchio.utils.rotate("z", yaw)
        root = pinocchio.XYZQUATToSE3(configuration[:7])
        moved = pinocchio.SE3(turn, wanted - turn @ is_at) * root
        configuration[:7] = pinocchio.SE3ToXYZQUAT(moved)
        return configuration

    def _com(self) -> np.ndarray:
        """Return the centre of mass above the middle of the first contacts."""
        data = self.model.createData()
        com = pinocchio.centerOfMass(self.model, data, self.start[: self.model.nq])
        first = self.content["phases"][0]["contacts"]
        middle = np.mean([each["position"] for each in first.values()], axis=0)
        return np.array([0.0, 0.0, com[2] - middle[2]])

    def _knot(
        self,
        contacts: dict[str, Any],
        com: np.ndarray,
        target: tuple[str, Any] | None,
        weight: float,
    ) -> Any:
        """Return the action model of one interval: contacts held, and an effector that moves."""
        state, controls = self.state, self.actuation.nu
        held = crocoddyl.ContactModelMultiple(state, controls)
        costs = crocoddyl.CostModelSum(state, controls)

        def add(name: str, residual: Any, weight: float, activation: Any = None) -> None:
            parts = [state, *([] if activation is None else [activation]), residual]
            costs.addCost(name, crocoddyl.CostModelResidual(*parts), weight)

        for name, contact in contacts.items():
            frame, pose = self.frames[name], placement(contact)
            held.addContact(
                name,
                crocoddyl.ContactModel6D(
                    state, frame, pose, pinocchio.LOCAL, controls, np.array([50.0, 30.0])
                ),
            )
            described = self.content["effectors"][name]
            size = 2.0 * np.array(described["half_size"])
            cone = crocoddyl.WrenchCone(pose.rotation, described["friction"], size)
            bounds = crocoddyl.ActivationBounds(cone.lb, cone.ub)
            add(
                f"{name}_cone",
                crocoddyl.ResidualModelContactWrenchCone(state, frame, cone, controls),
                1e1,
                crocoddyl.ActivationModelQuadraticBarrier(bounds),
            )
        if target is not None:
            residual = crocoddyl.ResidualModelFramePlacement(
                state, self.frames[target[0]], target[1], controls
            )
            add("swing", residual, weight)
        add("com", crocoddyl.ResidualModelCoMPosition(state, com, controls), 1e3)
        weights = np.array([0.0] * 3 + [500.0] * 3 + [0.01] * (state.nv - 6) + [10.0] * state.nv)
        add(
            "posture",
            crocoddyl.ResidualModelState(state, self.start, controls),
            1e-1,
            crocoddyl.ActivationModelWeightedQuad(weights**2),
        )
        add("torque", crocoddyl.ResidualModelControl(state, controls), 1e-3)
        dynamics = crocoddyl.DifferentialActionModelContactFwdDynamics(
            state, self.actuation, held, costs, 0.0, True
        )
        return crocoddyl.IntegratedActionModelEuler(dynamics, self.interval)


def main() -> None:
    """Read the command line, solve, and print where the effectors land."""
    parser = argparse.ArgumentParser(description="Walk a contact plan with Crocoddyl.")
    parser.add_argument("phases", type=Path)
    parser.add_argument("--robot", default="talos", help="name in example-robot-data")
    parser.add_argument("--interval", type=float, default=0.03, help="time of a knot [s]")
    parser.add_argument("--iterations", type=int, default=50)
    given = parser.parse_args()
    import example_robot_data  # pyright: ignore[reportMissingImports]

    robot = example_robot_data.load(given.robot)
    model = robot.model
    walk = Walk(model, robot.q0, json.loads(given.phases.read_text()), given.interval)
    problem = walk.problem()
    solver = crocoddyl.SolverFDDP(problem)
    states = [walk.start] * (problem.T + 1)
    done = solver.solve(states, list(problem.quasiStatic(states[:-1])), given.iterations, False)
    print(
        f"{problem.T} knots, {len(walk.content['phases'])} phases:"
        f" {'solved' if done else 'not solved'} in {solver.iter} iterations,"
        f" cost {solver.cost:.4g}"
    )
    data = model.createData()
    pinocchio.framesForwardKinematics(model, data, solver.xs[-1][: model.nq])
    for name, contact in walk.content["phases"][-1]["contacts"].items():
        away = data.oMf[walk.frames[name]].translation - np.array(contact["position"])
        print(f"{name}: {1000.0 * np.linalg.norm(away):.1f} mm from its last contact")


if __name__ == "__main__":
    main()
