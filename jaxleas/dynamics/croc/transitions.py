"""Contact transitions: what CROC is asked. Values of NumPy or of JAX, in any batch."""

from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

from jaxtyping import Bool, Float

from jaxleas.types import InputError

GRAVITY = 9.81  # standard gravity [m/s^2]
REACH_UNIT = 0.1  # a reach slack of this length [m] is a margin of one
LEAST_MARGIN = 1e-3  # margin from which on a transition is accepted [1]
NO_FORCE_LIMIT = 100.0  # [body weights]; stands for none: no contact point ever bears as much
LEAST_GENERATORS = 3
_DEGREES = (4, 6)
_LEAST_INSTANTS = 2

Numbers = Any
"""Arrays of NumPy or of JAX alike; their functions are found by `__array_namespace__`."""


class BoundaryState(NamedTuple):
    """The state of the centre of mass where a transition begins or ends.

    Attributes:
        com: position of the centre of mass in the world [m].
        velocity: its velocity [m/s].
        acceleration: its acceleration [m/s^2]; curves of degree 4 do not read it.
    """

    com: Float[Numbers, "*batch 3"]
    velocity: Float[Numbers, "*batch 3"]
    acceleration: Float[Numbers, "*batch 3"]


class Supports(NamedTuple):
    """The contact points of each support phase; rectangles are their four corners.

    Attributes:
        points: points of contact in the world [m].
        normals: unit contact normals, away from the surface.
        ahead: first axis of the contact that each point belongs to: the friction pyramid turns
            with it; zeros to align the pyramid with the world.
        standing: whether the point carries in the phase; others are padding.
    """

    points: Float[Numbers, "*batch S P 3"]
    normals: Float[Numbers, "*batch S P 3"]
    ahead: Float[Numbers, "*batch S P 3"]
    standing: Bool[Numbers, "*batch S P"]


class Reach(NamedTuple):
    """Polytopes that hold the centre of mass, rows . com <= bounds, in the world.

    Attributes:
        rows: outward unit normals of each phase's faces, the same at all its instants (L = 1) or
            of each instant; zeros are padding.
        bounds: offsets of the faces [m]; of padding: anything positive.
    """

    rows: Float[Numbers, "*batch S L R 3"]
    bounds: Float[Numbers, "*batch S L R"]


class Limits(NamedTuple):
    """Limits of a robot and of its ground; numbers, or one of each batch entry.

    Attributes:
        friction: friction coefficient mu [1].
        acceleration: largest acceleration of the centre of mass along each world axis [m/s^2].
        force: largest normal force of a contact point [body weights].
    """

    friction: float | Float[Numbers, "*#batch"] = 0.5
    acceleration: float | Float[Numbers, "*#batch"] = 10.0
    force: float | Float[Numbers, "*#batch"] = NO_FORCE_LIMIT


class Transitions(NamedTuple):
    """Contact transitions of one robot or of any batch of robots.

    Attributes:
        start: state at the beginning of the first phase.
        end: state at the end of the last phase.
        durations: durations of the S support phases [s].
        supports: contact points of each phase.
        reach: polytopes of the centre of mass in each phase.
        limits: friction, and the largest acceleration and force.
    """

    start: BoundaryState
    end: BoundaryState
    durations: Float[Numbers, "*batch S"]
    supports: Supports
    reach: Reach
    limits: Limits = Limits()


@dataclass(frozen=True)
class Discretisation:
    """Where along its curve a transition is checked; static under `jax.jit`.

    Attributes:
        degree: degree of the Bezier curve of the centre of mass: 4 fixes positions and velocities
            at both ends, 6 accelerations, too.
        kind: `instants` checks a few instants of each phase, both ends among them, and knows
            nothing of the time between; `everywhere` checks control points, and then the limits
            hold at all times. It accepts fewer transitions.
        instants: number of instants of each phase (`instants` only).
        pieces: number of pieces that each phase is cut into (`everywhere` only): more of them
            accept more transitions.
        generators: number of edges of each point's friction pyramid, which lies in the cone.

    Raises:
        InputError: a value is out of range.
    """

    degree: int = 4
    kind: Literal["instants", "everywhere"] = "instants"
    instants: int = 4
    pieces: int = 1
    generators: int = 4

    def __post_init__(self) -> None:
        if self.degree not in _DEGREES:
            raise InputError(
                f"a curve of degree {self.degree} is not built: 4 fixes positions and velocities at"
                " both ends, 6 accelerations, too"
            )
        if self.kind not in ("instants", "everywhere"):
            raise InputError(f"kind is {self.kind!r}: give 'instants' or 'everywhere'")
        if self.instants < _LEAST_INSTANTS:
            raise InputError(
                f"{self.instants} instants a phase: give {_LEAST_INSTANTS} or more, since both ends"
                " of a phase are checked"
            )
        if self.pieces < 1:
            raise InputError(f"{self.pieces} pieces a phase: give 1 or more")
        if self.generators < LEAST_GENERATORS:
            raise InputError(
                f"a friction pyramid needs {LEAST_GENERATORS} generators or more, not"
                f" {self.generators}"
            )

    @property
    def reach_instants(self) -> int:
        """Number of points of each phase at which reach is checked."""
        return self.instants if self.kind == "instants" else self.pieces * (self.degree + 1)

    @property
    def force_instants(self) -> int:
        """Number of points of each phase at which forces are sought."""
        return self.instants if self.kind == "instants" else self.pieces * (2 * self.degree - 2)
