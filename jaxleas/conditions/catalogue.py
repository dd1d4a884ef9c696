"""The conditions by name, and how a configuration's names become conditions."""

from collections.abc import Callable, Collection, Mapping, Sequence
from contextlib import nullcontext
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from jaxleas.conditions.condition import Condition, all_of, stated_points
from jaxleas.conditions.foresight import Foresight
from jaxleas.configuration import Registry, is_own, own_code
from jaxleas.robots import Robot
from jaxleas.types import InputError, RootMotion

if TYPE_CHECKING:
    from jaxleas.conditions.named import Named

SURROGATE = "surrogate"
KEY = "env.conditions"  # name of the configuration field, for messages


def _require_callable(name: str, item: Any) -> None:
    if not callable(item):
        raise InputError(
            f"{KEY}: {name} is no condition: give a class that is made from a robot and the points"
            " sampled anyway, and judges their heights (docs/your_own.md)"
        )


CONDITIONS: Registry[Callable[..., Any]] = Registry(
    "condition",
    {
        "reachability": "jaxleas.conditions.reachability:Reachability",
        "strict_reachability": "jaxleas.conditions.reachability:StrictReachability",
        "collision": "jaxleas.conditions.collision:Collision",
        SURROGATE: "jaxleas.surrogates.named:foresight_of",
    },
    _require_callable,
)
"""Each, except the surrogate, is called with the robot and the points that are sampled anyway."""


TITLES: Mapping[str, str] = MappingProxyType(
    {
        "reachability": "reachability R",
        "strict_reachability": "strict reachability R*",
        "collision": "collision C",
    }
)
"""What the package's conditions are called in sentences."""


@dataclass(frozen=True)
class EndingConditions:
    """The conditions that end an episode.

    Attributes:
        condition: condition with the smallest margin of all conditions.
        foresight: condition with memory; None: there is no such condition.
        named: conditions without memory, by the names that the configuration gives them.
    """

    condition: Condition
    foresight: Foresight | None
    named: Mapping[str, Condition]


def make_conditions(
    named: Sequence["Named"],
    robot: Robot,
    candidates: Float[np.ndarray, "C 2"],
    env: Any,
    allow: Collection[str] = (),
) -> EndingConditions:
    """Return the conditions that a configuration names.

    Args:
        named: names of the conditions.
        robot: robot that is judged.
        candidates: points in the root frame whose heights are sampled anyway [m]; conditions
            select from them, or state others.
        env: configuration of the environment, which a surrogate must fit.
        allow: user's own code that may be run, as MODULE:CLASS; code that only a file names is
            never run.

    Raises:
        InputError: a name is unknown, code may not be run or makes no condition, or a surrogate's
            file is missing or is for another robot; one sentence names the key.
    """
    made = [_make(each, robot, candidates, env, allow) for each in named]
    foresights = [each for each in made if _foresees(each)]
    by_name = {
        str(name): each for name, each in zip(named, made, strict=True) if not _foresees(each)
    }
    conditions = list(by_name.values())
    if len(foresights) > 1:
        raise InputError(f"{KEY}: an episode can follow one condition with memory: leave one out")
    if not conditions:
        raise InputError(f"{KEY}: no condition judges a configuration by itself: add collision")
    return EndingConditions(
        condition=all_of(*conditions, order=candidates),
        foresight=foresights[0] if foresights else None,
        named=by_name,
    )


def _make(
    each: "Named", robot: Robot, candidates: np.ndarray, env: Any, allow: Collection[str]
) -> Any:
    try:
        if not isinstance(each, str):
            return CONDITIONS.find(SURROGATE)(each, env)
        kind = CONDITIONS.find(each, allow)
    except InputError as error:
        raise InputError(f"{KEY}: {error}") from error
    with own_code(f"{KEY}: {each}") if is_own(each) else nullcontext():
        made = kind(robot, candidates)
        if not _foresees(made):
            _require_condition(each, made)
    return made


def _foresees(judge: Any) -> bool:
    return hasattr(judge, "begin") and hasattr(judge, "follow")


def _require_condition(name: str, made: Any) -> None:
    """Refuse the result of the user's own class if it is not a condition."""
    points = stated_points(made)
    if not callable(made) or points is None:
        missing = "points_in_root" if callable(made) else "__call__(heights_in_root, motion)"
        raise InputError(f"{KEY}: {name} makes a condition without {missing}: give it that")
    shape = np.shape(points)
    if len(shape) != 2 or shape[1] != 2 or not np.isfinite(points).all():
        raise InputError(
            f"{KEY}: {name} states points of shape {shape}; finite points [P, 2] in the root frame"
            " [m] would do"
        )
    robots = 2
    heights, motion = (
        jnp.zeros((robots, shape[0])),
        RootMotion(jnp.zeros((robots, 3)), jnp.zeros((robots, 3)), jnp.zeros(robots)),
    )
    margin = jax.eval_shape(made, heights, motion)
    if getattr(margin, "shape", None) != (robots,):
        raise InputError(
            f"{KEY}: {name} answers {robots} robots with {margin}; one margin for each, for any"
            " batch of robots, would do"
        )
