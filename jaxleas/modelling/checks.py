"""What must hold of a robot that was made, before its file is written."""

import numpy as np

from jaxleas.modelling.options import MakeOptions
from jaxleas.robots import Robot
from jaxleas.types import InputError

_UNDER_ROOT = 0.1
"""Half side of the square under the root in which R* looks for ground [m]."""
_FEWEST_CELLS = 3
_ON_FACE = 2e-3  # [m]


def require_sound(robot: Robot, options: MakeOptions) -> None:
    """Refuse a robot that could not be planned for.

    Args:
        robot: robot that was made.
        options: choices that it was made with.

    Raises:
        InputError: says what does not hold, and which choice would mend it.
    """
    _require_large(robot, options)
    for limb, place in zip(robot.legs, robot.references[list(robot.feet)], strict=True):
        for above in (*robot.start_heights, 0.0):
            height = robot.walking_height + above
            under = np.array([*place[:2], -height])
            if not limb.range_of_motion.contains(under, _ON_FACE):
                low, high = limb.range_of_motion.z_interval(place[None, :2])
                if np.isnan(low[0]):
                    reason = "its range of motion does not lie over that place"
                else:
                    reason = (
                        f"there it reaches from {-high[0]:.3f} to {-low[0]:.3f} m below the root"
                    )
                raise InputError(
                    f"{limb.name} cannot stand at its reference place with the root {height:.3f} m"
                    f" high, which walking_height {robot.walking_height:g} and start_heights"
                    f" {list(robot.start_heights)} allow: {reason}; state others"
                )
    _require_steps(robot)


def remarks(robot: Robot, com: np.ndarray) -> list[str]:
    """Return sentences about what a user should know of a robot that is sound.

    Args:
        robot: robot that was made.
        com: its centre of mass in the root frame, in the reference stance [m].
    """
    said = []
    places = robot.references[list(robot.feet)]
    half = np.array([robot.effectors[index].half_size for index in robot.feet])
    low, high = (places[:, :2] - half).min(axis=0), (places[:, :2] + half).max(axis=0)
    if not ((low - _ON_FACE <= com[:2]) & (com[:2] <= high + _ON_FACE)).all():
        said.append(
            f"in the reference stance the centre of mass, at ({com[0]:.3f}, {com[1]:.3f}) m, is not"
            " above the feet: state reference_sole or a stance by reference"
        )
    axis = np.linspace(-_UNDER_ROOT, _UNDER_ROOT, 6)
    under = np.stack(np.meshgrid(axis, axis), axis=-1).reshape(-1, 2)
    if not any(np.isfinite(leg.range_of_motion.z_interval(under)[0]).any() for leg in robot.legs):
        said.append(
            "no foot reaches below the root, within 0.1 m of it, where R* looks for ground:"
            " training and judging need that; widen the reach (reach.back, reach.ahead)"
        )
    if len(robot.legs) != 2:
        window = round(2.0 * float(np.abs(places[:, :2]).max()) + 2.0 * half.max() + 0.5, 1)
        said.append(
            f"contacts of {len(robot.legs)} feet are planned by mip and sl1m with model feet, with"
            f" --every 4 or less and --window {window:g}, and by sampling; astar is for two feet"
        )
    return said


def _require_large(robot: Robot, options: MakeOptions) -> None:
    """Refuse a robot whose legs reach over hardly any cell of the terrain."""
    for limb in robot.legs:
        bounds = limb.range_of_motion.bounds
        size = np.array(bounds.high[:2]) - np.array(bounds.low[:2])
        if size.min() < _FEWEST_CELLS * options.cell:
            raise InputError(
                f"the robot is too small for the terrain: {limb.name} reaches over"
                f" {size[0]:.3f} x {size[1]:.3f} m, and terrain has cells of {options.cell:g} m, of"
                f" which its feet need {_FEWEST_CELLS} each way; state the `cell` of finer terrain"
                " (terrain.resolution in a configuration)"
            )


def _require_steps(robot: Robot) -> None:
    """Refuse a reference stance that its own steps do not allow."""
    for name, polytope in robot.steps.items():
        moving, _, standing = name.partition("_in_")
        if moving == "COM":
            continue
        place = robot.references[robot.effector_index(moving)]
        other = robot.references[robot.effector_index(standing)]
        if not polytope.contains(place - other, _ON_FACE):
            x, y, _ = np.round(place - other, 3).tolist()
            raise InputError(
                f"{moving} stands at ({x}, {y}) m from {standing} in the reference stance, which no"
                " step reaches: state a smaller step.apart, or reference_sole"
            )
