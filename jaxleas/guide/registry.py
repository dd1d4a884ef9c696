"""The one place where steering methods are named."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from jaxleas.configuration.registry import Registry, is_own
from jaxleas.envs.steering.config import MotionLimits
from jaxleas.guide.rb_kino import rb_kino
from jaxleas.guide.rb_lin import rb_lin
from jaxleas.types.errors import InputError

if TYPE_CHECKING:
    from jaxleas.envs.steering.env import SteeringEnv
    from jaxleas.guide.steering_method import SteeringMethod

LEAS = "leas"
"""The policy itself, which is not made of limits and speed alone."""


@dataclass(frozen=True)
class Baseline:
    """A steering method that is made of a task's limits and needs no policy.

    Attributes:
        key: its name in result files.
        title: its name for people.
        make: makes it of the root's limits and the desired speed [m/s].
    """

    key: str
    title: str
    make: "Callable[[MotionLimits, float], SteeringMethod]"


KINO = Baseline("rb_kino", "RB-Kino", rb_kino)
LIN = Baseline("rb_lin", "RB-Lin", rb_lin)
BASELINES = {each.key: each for each in (LIN, KINO)}
"""By their names in result files."""


def _require_method(name: str, item: Any) -> None:
    if not callable(item):
        raise InputError(
            f"{name} makes no steering method: give a class or a function of the root's limits and"
            " the desired speed, as jaxleas.guide.rb_lin is one"
        )


STEERING_METHODS: Registry[Any] = Registry(
    "steering method",
    {
        LEAS: "jaxleas.guide.leas:leas",
        "kino": "jaxleas.guide.registry:KINO",
        "lin": "jaxleas.guide.registry:LIN",
    },
    _require_method,
)


def baseline_named(name: str, env: "SteeringEnv") -> "SteeringMethod":
    """Return the steering method of that name for an environment's limits and desired speed.

    Args:
        name: name that a person gave on a command line or in a call, which permits code of one's
            own: kino, lin, or MODULE:CLASS.
        env: environment that it moves in.

    Raises:
        InputError: there is no such method, or it cannot be made.
    """
    found = STEERING_METHODS.find(name, allow=[name])
    make = found if is_own(name) else found.make
    return make(env.config.limits, env.config.desired_speed)
