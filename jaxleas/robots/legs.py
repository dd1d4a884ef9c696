"""The legs of a robot, for planners that move their joints: any number, alike or not."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache, cached_property

import numpy as np
from jaxtyping import Bool, Float, Int

from jaxleas.robots.leg_kinds import require_that_feet_can_stand, same_model
from jaxleas.robots.limb_model import Body, LimbModel
from jaxleas.robots.robot import Robot
from jaxleas.types import InputError


@dataclass(frozen=True, eq=False)
class Legs:
    """The limbs that carry a walking robot, in the order of its feet, and the rest of its mass.

    Legs that are mirror images of each other in the root's plane y = 0 share one model. For a leg
    of side -1 mirror inputs and outputs of its model: positions by (1, -1, 1), rotations by that on
    both sides, angles by the `mirror_signs` of its chain.

    Attributes:
        models: models of the legs, one for all legs that share it.
        model_of: index of each leg's model.
        side: -1 for a leg that is the mirror image of its model, else +1.
        corners: corners of each sole in its frame, counter-clockwise, the last one repeated where
            others have more [m].
        has_corner: whether each of them is a corner of its own.
        friction: friction coefficient mu of each foot [1].
        body: all of the robot except its legs; limbs that do not stand, such as arms with palms,
            are in their reference posture.
    """

    models: tuple[LimbModel, ...]
    model_of: Int[np.ndarray, " F"]
    side: Float[np.ndarray, " F"]
    corners: Float[np.ndarray, "F C 2"]
    has_corner: Bool[np.ndarray, "F C"]
    friction: Float[np.ndarray, " F"]
    body: Body

    def __len__(self) -> int:
        """Return the number of legs."""
        return len(self.side)

    @cached_property
    def others(self) -> Int[np.ndarray, "F F-1"]:
        """For each leg, the indices of all other legs."""
        every = range(len(self))
        return np.array([[other for other in every if other != leg] for leg in every])

    @cached_property
    def mass(self) -> float:
        """Mass of the whole robot [kg]."""
        legs = [float(self.models[number].link_mass.sum()) for number in self.model_of]
        return self.body.mass + sum(legs)

    @cached_property
    def most_joints(self) -> int:
        """Number of joints of the leg that has most."""
        return max(len(model.chain) for model in self.models)

    @cached_property
    def com_reach(self) -> tuple[Float[np.ndarray, "F R 3"], Float[np.ndarray, "F R"]]:
        """Face normals and offsets of the reach of the centre of mass from each foot.

        Rows are in the foot's frame rotated only by its yaw [m]. Where a reach has fewer faces than
        others, rows of zeros with a positive offset follow, which hold everywhere.
        """
        reaches = [self.models[number].com_reach for number in self.model_of]
        most = max(len(reach.offsets) for reach in reaches)
        normals, offsets = np.zeros((len(self), most, 3)), np.ones((len(self), most))
        for leg, reach in enumerate(reaches):
            normals[leg, : len(reach.offsets)] = reach.normals * [1.0, self.side[leg], 1.0]
            offsets[leg, : len(reach.offsets)] = reach.offsets
        return normals, offsets

    @cached_property
    def com_heights(self) -> tuple[float, float]:
        """Lowest and highest place of the centre of mass above a foot in any reach [m]."""
        bounds = [model.com_reach.bounds for model in self.models]
        return min(float(each.low[2]) for each in bounds), max(
            float(each.high[2]) for each in bounds
        )

    def by_model(
        self, leg: Int[np.ndarray, " N"]
    ) -> Iterator[tuple[int, Int[np.ndarray, " M"] | slice]]:
        """Yield the index of each model and the rows of the legs that have it.

        Args:
            leg: index of each row's leg.
        """
        if len(self.models) == 1:
            yield 0, slice(None)
            return
        which = self.model_of[leg]
        for number in range(len(self.models)):
            rows = np.flatnonzero(which == number)
            if len(rows):
                yield number, rows


@cache
def legs_of(robot: Robot) -> Legs:
    """Return the legs of a robot.

    Raises:
        InputError: the robot's file does not describe its legs, or it could not stand on the others
            while it moves one of them.
    """
    described = [robot.limbs[index].model for index in robot.feet]
    models = [model for model in described if model is not None]
    if robot.body is None or len(models) < len(described):
        raise InputError(
            f"the file of robot '{robot.name}' has no 'body', or a leg of it no 'model': a planner"
            " that moves joints needs both; `jaxleas robot make` makes them from a URDF"
        )
    effectors = [robot.effectors[index] for index in robot.feet]
    require_that_feet_can_stand(robot.name, effectors, models)
    shared, model_of, side = _share(models)
    most = max(len(effector.corners) for effector in effectors)
    corners = [effector.corners[:, :2] for effector in effectors]
    return Legs(
        models=shared,
        model_of=model_of,
        side=side,
        corners=np.stack([np.pad(c, ((0, most - len(c)), (0, 0)), mode="edge") for c in corners]),
        has_corner=np.array([np.arange(most) < len(each) for each in corners]),
        friction=np.array([effector.friction for effector in effectors]),
        body=_with_resting_limbs(robot, robot.body),
    )


def _share(
    models: list[LimbModel],
) -> tuple[tuple[LimbModel, ...], Int[np.ndarray, " F"], Float[np.ndarray, " F"]]:
    """Return each model once, the index of each leg's model, and its side."""
    shared: list[LimbModel] = []
    model_of, side = [], []
    for model in models:
        for number, known in enumerate(shared):
            sides = [s for s, image in ((-1.0, known.mirrored()), (1.0, known))
                     if same_model(image, model)]  # fmt: skip
            if sides:
                model_of.append(number)
                side.append(sides[0])
                break
        else:
            model_of.append(len(shared))
            side.append(1.0)
            shared.append(model)
    return tuple(shared), np.array(model_of), np.array(side)


def _with_resting_limbs(robot: Robot, body: Body) -> Body:
    """Return the body together with the limbs that do not stand, in their reference posture."""
    moment, mass = body.mass * body.com, body.mass
    resting = [
        limb.model
        for index, limb in enumerate(robot.limbs)
        if index not in robot.feet and limb.model is not None
    ]
    for model in resting:
        posture = model.posture(model.reference)
        moment = moment + model.mass_moment(posture.frames, posture.origins)
        mass += float(model.link_mass.sum())
    return Body(mass, moment / mass) if resting else body
