"""Numbers that the thesis prints in tables 5.9 to 5.21, without its copy errors.

Left out are the planner's rows of scenario 2.2 in table 5.17, which repeat scenario 1.2 of table
5.12 line by line, and its distances in table 5.21, which repeat scenario 2.1 of table 5.17.
"""

from dataclasses import dataclass

Runs = tuple[float, ...]


@dataclass(frozen=True)
class BlindRun:
    """A walk of the thesis's controller without a map.

    Attributes:
        landings: number of landings of each foot.
        unsafe: number of those nearer than 1.5 cm to an edge, of each foot.
        crossed: whether it got to the end.
    """

    landings: int
    unsafe: tuple[int, int, int, int]
    crossed: bool = True


@dataclass(frozen=True)
class Scenario:
    """One scenario of the thesis, three runs.

    Attributes:
        course: the course here.
        number: its number.
        time_mean: mean time of a plan [ms].
        time_most: longest time of a plan [ms].
        com_x, com_y, yaw: mean errors of the centre of mass [cm], and of the heading [rad].
        foot_x, foot_y: mean errors of landings [cm].
        landings: number of landings of each foot.
        unsafe: number of unsafe landings of the worst foot; none where they are copy errors.
        nearest: least distance of a landing from an edge [cm]; likewise.
        blind: walks without a map by speed over the largest.
    """

    course: str
    number: str
    time_mean: Runs
    time_most: Runs
    com_x: Runs
    com_y: Runs
    yaw: Runs
    foot_x: Runs
    foot_y: Runs
    landings: tuple[int, ...]
    unsafe: tuple[int, ...]
    nearest: Runs
    blind: dict[str, BlindRun]


SCENARIOS = (
    Scenario(
        course="stairs_1",
        number="1.1",
        time_mean=(2.004, 1.998, 1.957),
        time_most=(5.848, 4.998, 4.055),
        com_x=(2.53, 2.43, 2.62),
        com_y=(1.18, 1.19, 1.34),
        yaw=(0.00388, 0.00376, 0.00355),
        foot_x=(1.37, 1.25, 1.47),
        foot_y=(1.09, 1.08, 1.03),
        landings=(78, 79, 78),
        unsafe=(0, 1, 0),
        nearest=(1.81, 1.28, 2.82),
        blind={
            "0.2": BlindRun(201, (11, 19, 13, 19)),
            "0.4": BlindRun(92, (11, 1, 12, 2)),
            "0.6": BlindRun(61, (2, 5, 8, 3)),
            "0.8": BlindRun(45, (3, 2, 3, 3)),
            "1.0": BlindRun(37, (2, 3, 2, 4)),
        },
    ),
    Scenario(
        course="stairs_2",
        number="1.2",
        time_mean=(2.274, 1.678, 1.588),
        time_most=(5.321, 3.664, 5.903),
        com_x=(2.64, 2.55, 2.33),
        com_y=(1.22, 1.18, 1.38),
        yaw=(0.00322, 0.00321, 0.00333),
        foot_x=(1.49, 1.31, 1.2),
        foot_y=(1.11, 1.05, 1.09),
        landings=(57, 58, 57),
        unsafe=(1, 0, 0),
        nearest=(1.1, 3.38, 2.26),
        blind={
            "0.2": BlindRun(164, (13, 16, 16, 15)),
            "0.4": BlindRun(75, (8, 6, 6, 4)),
            "0.6": BlindRun(61, (6, 8, 6, 8)),
            "0.8": BlindRun(49, (2, 2, 3, 2)),
            "1.0": BlindRun(37, (4, 1, 1, 4)),
        },
    ),
    Scenario(
        course="stairs_3",
        number="1.3",
        time_mean=(1.577, 2.075, 1.637),
        time_most=(2.681, 5.911, 3.311),
        com_x=(2.92, 3.13, 3.24),
        com_y=(1.5, 1.71, 1.52),
        yaw=(0.00315, 0.00326, 0.00324),
        foot_x=(1.86, 1.8, 1.83),
        foot_y=(1.44, 1.72, 1.56),
        landings=(39, 40, 40),
        unsafe=(1, 1, 2),
        nearest=(1.0, 1.2, 1.03),
        blind={
            "0.2": BlindRun(145, (12, 14, 15, 13)),
            "0.4": BlindRun(67, (8, 7, 6, 5)),
            "0.6": BlindRun(44, (5, 5, 4, 6)),
            "0.8": BlindRun(34, (1, 3, 4, 1)),
            "1.0": BlindRun(21, (2, 1, 1, 1), crossed=False),
        },
    ),
    Scenario(
        course="gaps_1",
        number="2.1",
        time_mean=(2.119, 2.208, 1.965),
        time_most=(4.721, 4.384, 5.492),
        com_x=(1.19, 1.29, 1.15),
        com_y=(1.15, 1.18, 1.12),
        yaw=(0.00201, 0.00199, 0.002),
        foot_x=(1.06, 0.998, 1.05),
        foot_y=(1.01, 1.02, 0.998),
        landings=(44, 44, 45),
        unsafe=(0, 0, 0),
        nearest=(3.37, 4.86, 3.91),
        blind={
            "0.2": BlindRun(14, (2, 0, 0, 0), crossed=False),
            "0.4": BlindRun(9, (1, 0, 0, 0), crossed=False),
            "0.6": BlindRun(8, (1, 1, 1, 0), crossed=False),
            "0.8": BlindRun(6, (0, 0, 0, 0), crossed=False),
            "1.0": BlindRun(4, (0, 0, 0, 0), crossed=False),
        },
    ),
    Scenario(
        course="gaps_2",
        number="2.2",
        time_mean=(1.819, 2.356, 2.008),
        time_most=(4.231, 5.987, 4.986),
        com_x=(1.17, 1.26, 1.14),
        com_y=(1.14, 1.11, 1.1),
        yaw=(0.00192, 0.00193, 0.00199),
        foot_x=(0.992, 1.05, 1.01),
        foot_y=(0.999, 1.03, 1.0),
        landings=(),
        unsafe=(),
        nearest=(),
        blind={
            "0.2": BlindRun(16, (1, 0, 0, 0), crossed=False),
            "0.4": BlindRun(9, (0, 0, 1, 0), crossed=False),
            "0.6": BlindRun(6, (0, 0, 1, 0), crossed=False),
            "0.8": BlindRun(5, (0, 0, 0, 0), crossed=False),
            "1.0": BlindRun(4, (0, 0, 0, 0), crossed=False),
        },
    ),
    Scenario(
        course="waypoints",
        number="3.1",
        time_mean=(2.005, 2.351, 2.42),
        time_most=(4.333, 4.734, 5.892),
        com_x=(0.997, 1.02, 1.01),
        com_y=(0.862, 0.834, 0.863),
        yaw=(0.00203, 0.00199, 0.00201),
        foot_x=(0.983, 0.986, 0.991),
        foot_y=(0.968, 0.971, 0.972),
        landings=(88, 87, 89),
        unsafe=(0, 0, 0),
        nearest=(),
        blind={
            "0.2": BlindRun(254, (8, 7, 9, 9)),
            "0.4": BlindRun(111, (7, 6, 4, 5)),
            "0.6": BlindRun(81, (3, 4, 2, 3)),
            "0.8": BlindRun(56, (5, 4, 3, 4)),
            "1.0": BlindRun(33, (2, 2, 3, 2)),
        },
    ),
)
