"""What cannot be shown or recorded, refused before anything is loaded."""

from collections.abc import Sequence
from pathlib import Path

from jaxleas.types import InputError

FARTHEST = 1e6  # largest coordinate of a start or a goal [m]


def require_drive(
    driven: Sequence[str],
    start: tuple[float, float, float] | None,
    goal: tuple[float, float] | None,
) -> None:
    """Refuse a start or a goal without a robot, or with numbers that are no place.

    Args:
        driven: policies and controllers to drive, if any.
        start: start of the robots: x, y [m] and heading [deg]; None if not given.
        goal: first goal of the robots: x, y [m]; None if not given.

    Raises:
        InputError: one of them is refused.
    """
    for option, numbers, wanted in (
        ("--start", start, "x y [m], yaw [deg]"),
        ("--goal", goal, "x y [m]"),
    ):
        if numbers is not None and not all(abs(each) < FARTHEST for each in numbers):
            given = " ".join(f"{each:g}" for each in numbers)
            raise InputError(f"{option} {given}: give finite numbers below 1000 km, {wanted}")
        if numbers is not None and not driven:
            raise InputError(
                f"{option} needs --policies or --controller: there is no robot to walk there"
            )


def require_moving(
    driven: Sequence[str],
    goal: tuple[float, float] | None,
    guide: Path | None,
    plan: Path | None,
    record: Path | None,
) -> None:
    """Refuse a recording in which nothing moves.

    Args:
        driven: policies and controllers to drive, if any.
        goal: first goal of the robots: x, y [m].
        guide: file of guide paths to play back.
        plan: file of a contact plan to play back.
        record: file of the recording; None: nothing is recorded.

    Raises:
        InputError: nothing moves, or the file is not named as a page.
    """
    if record is None:
        return
    if record.suffix != ".html":
        raise InputError(f"--record {record}: recordings are written as .html")
    if driven and goal is None:
        raise InputError("--record with a robot needs --goal X Y: where it walks to")
    if not (driven or guide or plan):
        raise InputError(
            "--record needs something that moves: --policies, --controller, --guide or --plan"
        )
