"""Settings of the model-based trot."""

from dataclasses import asdict, dataclass
from typing import Literal

TouchdownRule = Literal["speed_error", "capture"]
"""Where a foot touches down, ahead of its nominal place under the hip: half of the way that the
hip goes while the foot stands, plus a share of the speed error; or plus the error of the capture
point, the square root of height over gravity times the speed error."""


@dataclass(frozen=True)
class TrotSettings:
    """How a trot walks; all of it belongs to the controller's identity.

    Attributes:
        cycle: duration of a gait cycle, in which each pair of feet swings once [s].
        duty: share of the cycle during which a foot stands.
        swing_height: height of the apex of a swing above lift-off and touchdown [m].
        touchdown: rule by which the feet touch down.
        speed_error_gain: how far a foot is set ahead per speed error, by the rule of that name [s].
        height: height of the root above the middles of the standing feet [m].
        max_speeds: largest forward and sideways speed [m/s] and turning rate [rad/s].
        friction: friction coefficient that ground forces are kept within.
    """

    cycle: float = 0.60
    duty: float = 0.55
    swing_height: float = 0.065
    touchdown: TouchdownRule = "speed_error"
    speed_error_gain: float = 0.12
    height: float = 0.42
    max_speeds: tuple[float, float, float] = (1.0, 0.5, 1.0)
    friction: float = 0.5

    @property
    def stance_time(self) -> float:
        """Duration of a stance of a foot [s]."""
        return self.duty * self.cycle

    @property
    def swing_time(self) -> float:
        """Duration of a swing [s]."""
        return (1.0 - self.duty) * self.cycle

    def as_identity(self) -> dict[str, float | str]:
        """Return the settings that an identity records beyond its own entries."""
        known = ("swing_height", "max_speeds")
        return {key: value for key, value in asdict(self).items() if key not in known}


@dataclass(frozen=True)
class TrotGains:
    """Gains of the trot's feedback, which were found by hand on level ground.

    Attributes:
        height: acceleration per height error [1/s2].
        climb: deceleration per vertical speed [1/s].
        speed: acceleration per error of the horizontal speed [1/s].
        tilt: angular acceleration per error of roll and pitch [1/s2].
        tilt_rate: angular deceleration per rate of roll and pitch [1/s].
        turning: angular acceleration per error of the turning rate [1/s].
        swing_stiffness: force on a swinging foot per error of its place [N/m].
        swing_damping: force on a swinging foot per error of its velocity [N s/m].
        swing_mass: mass that a swinging foot seems to have, the leg's behind it [kg].
    """

    height: float = 120.0
    climb: float = 18.0
    speed: float = 6.0
    tilt: float = 200.0
    tilt_rate: float = 24.0
    turning: float = 15.0
    swing_stiffness: float = 2500.0
    swing_damping: float = 70.0
    swing_mass: float = 0.9


TROT, GAINS = TrotSettings(), TrotGains()
"""Those of the trot called so."""
