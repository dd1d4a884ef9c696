"""The one place where steering methods are named."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Annotated, Any

from jaxleas.configuration import Registry, is_own
from jaxleas.types import InputError

if TYPE_CHECKING:
    from jaxleas.envs.steering import SteeringEnv
    from jaxleas.guide.onnx_policy import OnnxPolicy
    from jaxleas.guide.steering_method import SteeringMethod
    from jaxleas.training import Policy

_ROADMAP = "_rrt"


@dataclass(frozen=True)
class Edges:
    """The edges of a roadmap that suit a steering method.

    A method that needs the way to a waypoint to be free has short edges and follows them to the
    centimetre, because the way that a cut corner takes has not been tried.

    Attributes:
        reach: maximum length of an edge of a tree [m].
        radius: distance within which a waypoint counts as reached [m]; None for the radius within
            which the task's goal is reached.
    """

    reach: float = 1.5
    radius: float | None = 0.01


@dataclass(frozen=True)
class Method:
    """A steering method: its names, and all that differs from one method to another.

    Attributes:
        name: name on command lines.
        key: name in result files.
        title: name for readers.
        make: function that makes the method from an environment, whose limits and desired speed it
            keeps, and from a policy, which is None where there is none.
        needs_policy: whether the method cannot be made without a policy; one that can is a
            baseline.
        edges: edges of a roadmap that suit the method.
        colour: colour in pictures.
        roadmap_colour: colour in pictures of the method with a roadmap; None for a method that
            comparisons do not show with a roadmap unless they are asked to.
    """

    name: str
    key: str
    title: str
    make: "Callable[[SteeringEnv, Policy | OnnxPolicy | None], SteeringMethod]"
    needs_policy: bool = False
    edges: Edges = Edges()
    colour: str = "#8a3fb5"
    roadmap_colour: str | None = None

    @property
    def roadmap_key(self) -> str:
        """Name in result files of the method with a roadmap."""
        return self.key + _ROADMAP

    def with_roadmap(self) -> "Method":
        """Return the names and colours of the method with a roadmap of waypoints."""
        return replace(
            self,
            name=self.name + _ROADMAP,
            key=self.roadmap_key,
            title=f"{self.title} + RRT",
            colour=self.roadmap_colour or Method.colour,
        )


def _make_leas(env: "SteeringEnv", policy: "Policy | OnnxPolicy | None") -> "SteeringMethod":
    from jaxleas.guide.leas import leas

    if policy is None:
        raise InputError("the steering method leas needs a policy: a run folder, .npz or .onnx")
    return leas(env, policy)


def _make_lin(env: "SteeringEnv", policy: "Policy | OnnxPolicy | None") -> "SteeringMethod":
    from jaxleas.guide.rb_lin import rb_lin

    del policy
    return rb_lin(env.config.limits, env.config.desired_speed)


def _make_kino(env: "SteeringEnv", policy: "Policy | OnnxPolicy | None") -> "SteeringMethod":
    from jaxleas.guide.rb_kino import rb_kino

    del policy
    return rb_kino(env.config.limits, env.config.desired_speed)


LEAS = Method(
    "leas",
    "leas_p1",
    "LEAS-P1",
    _make_leas,
    needs_policy=True,
    # It passes near a waypoint and avoids obstacles on the way.
    edges=Edges(reach=4.0, radius=None),
    colour="#1f5fd0",
)
LIN = Method("lin", "rb_lin", "RB-Lin", _make_lin, colour="#7a7a7a")
KINO = Method("kino", "rb_kino", "RB-Kino", _make_kino, colour="#2e9e4f", roadmap_colour="#b8860b")
METHODS = (LEAS, LIN, KINO)
"""The built-in steering methods."""
BASELINES = {each.key: each for each in METHODS if not each.needs_policy}
"""The built-in methods that need no policy, by their names in result files."""


def _require_method(name: str, item: Any) -> None:
    if not (callable(item) or isinstance(item, Method)):
        raise InputError(
            f"{name} makes no steering method: give a class or a function of the root's limits and"
            " the desired speed, as jaxleas.guide.rb_lin is one, or a jaxleas.guide.Method"
        )


STEERING_METHODS: Registry[Any] = Registry(
    "steering method",
    {each.name: f"{__name__}:{each.name.upper()}" for each in METHODS},
    _require_method,
)
SteeringName = Annotated[str, STEERING_METHODS]
"""Type of a command's option: its help lists the steering methods."""


class _ResultNames:
    """The names of methods in results, for a command's help."""

    def describe(self) -> str:
        """Return the list of names that a method of a comparison can have."""
        return f"{', '.join(compared())}, or MODULE:CLASS of your own"


ResultName = Annotated[str, _ResultNames()]
"""Type of a command's option: its help lists the methods of a comparison."""


def find_method(name: str) -> Method:
    """Return the steering method of that name.

    Args:
        name: name that a person gave on a command line or in a call, which permits code of one's
            own: the name or the key of a built-in method, or MODULE:CLASS.

    Raises:
        InputError: there is no such method.
    """
    for each in METHODS:
        if name in (each.name, each.key):
            return each
    found = STEERING_METHODS.find(name, allow=[name])
    if isinstance(found, Method):  # results must not take it for a built-in one
        return replace(found, name=name, key=name)

    def make(env: "SteeringEnv", policy: "Policy | OnnxPolicy | None") -> "SteeringMethod":
        del policy
        return found(env.config.limits, env.config.desired_speed)

    return Method(name, name, name, make)


def require_guardable(method: Method, guard: bool | None) -> None:
    """Refuse to guard a steering method that is no policy: its walks are compared as they are.

    Raises:
        InputError: a guard was asked for, and the method is not a policy.
    """
    if guard and not method.needs_policy:
        raise InputError(
            f"--guard watches over a policy's walks, and --steering {method.name} is none: leave"
            " one of them out"
        )


def method_of(key: str) -> Method | None:
    """Return the built-in method of a name in result files, with a roadmap or without.

    Code is never run: a method of one's own, or a policy of another name, gives None.
    """
    for each in METHODS:
        if key == each.key:
            return each
        if key == each.roadmap_key:
            return each.with_roadmap()
    return None


def compared() -> list[str]:
    """Return the names in result files of the methods that a comparison shows by default."""
    with_roadmap = [each.roadmap_key for each in METHODS if each.roadmap_colour is not None]
    return [*BASELINES, *with_roadmap, LEAS.key]


def is_policy(key: str) -> bool:
    """Return whether results of that name are a policy's, and not those of a baseline."""
    found = method_of(key)
    return not is_own(key) if found is None else found.needs_policy
