"""Settings of the phase tracker."""

from dataclasses import dataclass


@dataclass(frozen=True)
class TrackerSettings:
    """How a phase tracker follows a plan; gains were found by hand on drawn fields.

    Attributes:
        clearance: height of a swing above all that is on its way, and above its ends [m].
        friction: friction coefficient that ground forces are kept within.
        least_force: least normal force of a standing foot [N].
        settles: time in which the robot stands before its plan begins [s].
        lifts_late: time between the begin of a support and the lift of a foot [s], at most a tenth
            of the swing.
        lands_early: time between a touchdown and the begin of the next support [s], at most a
            tenth of the swing.
        inside: distance of the centre of mass inside the other feet from which on a foot is
            lifted [m].
        waits: longest time for which the plan waits for a foot or for the centre of mass [s].
        place: acceleration per error of the centre of mass [1/s2].
        speed: acceleration per error of its velocity [1/s].
        tilt: angular acceleration per error of roll, pitch and heading [1/s2].
        tilt_rate: angular acceleration per error of their rates [1/s].
        swing_stiffness: force on a swinging foot per error of its place [N/m].
        swing_damping: force on a swinging foot per error of its velocity [N s/m].
        swing_mass: mass that a swinging foot seems to have, the leg's behind it [kg].
    """

    clearance: float = 0.06
    friction: float = 0.6
    least_force: float = 10.0
    settles: float = 0.4
    lifts_late: float = 0.1
    lands_early: float = 0.1
    inside: float = 0.01
    waits: float = 1.5
    place: float = 80.0
    speed: float = 18.0
    tilt: float = 200.0
    tilt_rate: float = 24.0
    swing_stiffness: float = 2500.0
    swing_damping: float = 70.0
    swing_mass: float = 0.9
