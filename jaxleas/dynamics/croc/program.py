"""The linear program of a contact transition: its assembly, a pure function.

    max t  over t, the free point x and the forces f of all contact points at all force instants,
    subject to
      sum_p f = push + push_share x              (force, in body weights)
      sum_p arm x f = turn + turn_slope x x      (torque about the origin, in body weights times m)
      face . f - t >= 0,  -normal . f - t >= -limit              (each standing point)
      bound - share row . x - t >= 0             (reach over 10 cm; acceleration over gravity)

t is the margin, without a unit: the least of the forces' distances from the faces of their friction
pyramids over the body weight, and of reach slack over 10 cm (Tonneau et al. 2018, "2PAC"; Tsounis
et al. 2020, "DeepGait", sec. II-D). An acceleration's slack, times the mass, is a force.
"""

from typing import NamedTuple

from jaxtyping import Bool, Float

from jaxleas.dynamics.croc.curves import (
    AffinePoints,
    acceleration_of,
    bernstein,
    cross_product,
    elevation,
    free_curve,
    namespace,
    product,
    restriction,
)
from jaxleas.dynamics.croc.friction_pyramid import force_faces
from jaxleas.dynamics.croc.transitions import (
    GRAVITY,
    REACH_UNIT,
    Discretisation,
    Numbers,
    Transitions,
)


class Rows(NamedTuple):
    """Limits on the free point alone: bounds - share rows . x - t >= 0.

    Attributes:
        rows: directions, of G groups of instants that share them.
        share: factors of the free point at each instant.
        bounds: slack at x = 0.
    """

    rows: Float[Numbers, "*batch G R 3"]
    share: Float[Numbers, "*batch G L"]
    bounds: Float[Numbers, "*batch G L R"]


class Programs(NamedTuple):
    """Linear programs of a batch of transitions; S phases, W force instants, P points, F faces.

    Attributes:
        origin: point from which all positions count, x included [m].
        arms: points of contact [m].
        faces: inward normals of the limits of each force.
        standing: whether the point carries.
        limit: largest normal force [body weights].
        push: force needed for x = 0 [body weights].
        push_share: factor of x in the force needed.
        turn: torque needed for x = 0 [body weights m].
        turn_slope: torque needed beyond it is turn_slope x x.
        reach: limits of the positions.
        acceleration: limits of the accelerations.
    """

    origin: Float[Numbers, "*batch 3"]
    arms: Float[Numbers, "*batch S P 3"]
    faces: Float[Numbers, "*batch S P F 3"]
    standing: Bool[Numbers, "*batch S P"]
    limit: Float[Numbers, "*batch"]
    push: Float[Numbers, "*batch S W 3"]
    push_share: Float[Numbers, "*batch S W"]
    turn: Float[Numbers, "*batch S W 3"]
    turn_slope: Float[Numbers, "*batch S W 3"]
    reach: Rows
    acceleration: Rows


def assemble(transitions: Transitions, discretisation: Discretisation) -> Programs:
    """Return the linear programs of transitions, whose shapes and values must be right.

    Works on arrays of NumPy and of JAX alike, traced ones included.

    Args:
        transitions: transitions of any batch shape.
        discretisation: degree of the curve, and where it is checked.
    """
    xp = namespace(transitions.durations)
    batch = transitions.durations.shape[:-1]
    total = transitions.durations.sum(axis=-1)
    limits = [
        xp.broadcast_to(xp.asarray(each, dtype=total.dtype), batch) for each in transitions.limits
    ]
    friction, most_acceleration, most_force = limits
    supports = transitions.supports
    origin = _origin(transitions)
    start = transitions.start._replace(com=transitions.start.com - origin)
    end = transitions.end._replace(com=transitions.end.com - origin)
    curve = free_curve(start, end, total, discretisation.degree)
    com, acceleration, push, turn = _checked(transitions.durations, curve, discretisation)
    return Programs(
        origin,
        supports.points - origin[..., None, None, :],
        force_faces(supports, friction, discretisation.generators),
        supports.standing,
        most_force,
        push.constant,
        push.share,
        *turn,
        _reach_rows(transitions, origin, com),
        _acceleration_rows(acceleration, most_acceleration / GRAVITY),
    )


def _origin(transitions: Transitions) -> Numbers:
    """Return the middle of the standing points: the programs do not know where the world begins."""
    standing = transitions.supports.standing[..., None]
    weight = standing / (standing.sum(axis=(-3, -2, -1))[..., None, None, None] + 1e-9)
    return (weight * transitions.supports.points).sum(axis=(-3, -2))


def _checked(
    durations: Numbers, curve: AffinePoints, discretisation: Discretisation
) -> tuple[AffinePoints, AffinePoints, AffinePoints, tuple[Numbers, Numbers]]:
    """Return position, acceleration, and wrench over weight at the instants or control points."""
    xp = namespace(durations)
    degree = discretisation.degree
    total = durations.sum(axis=-1)
    acceleration = acceleration_of(curve, total)
    lift = xp.asarray([0.0, 0.0, 1.0], dtype=total.dtype)
    ends = xp.cumsum(durations, axis=-1) / total[..., None]
    begins = ends - durations / total[..., None]
    spread = _per_phase(curve), _per_phase(acceleration)
    if discretisation.kind == "instants":
        inside = xp.linspace(0.0, 1.0, discretisation.instants, dtype=total.dtype)
        at = begins[..., None] + (ends - begins)[..., None] * inside
        com = spread[0].through(bernstein(degree, at))
        pull = _over_weight(spread[1].through(bernstein(degree - 2, at)), lift)
        turn = cross_product(com.constant, pull.constant)
        slope = pull.share[..., None] * com.constant - com.share[..., None] * pull.constant
        return com, pull, pull, (turn, slope)
    cuts = xp.linspace(0.0, 1.0, discretisation.pieces + 1, dtype=total.dtype)
    at = begins[..., None] + (ends - begins)[..., None] * cuts
    com = _per_phase(spread[0]).through(restriction(degree, at[..., :-1], at[..., 1:]))
    part = restriction(degree - 2, at[..., :-1], at[..., 1:])
    pull = _over_weight(_per_phase(spread[1]).through(part), lift)
    pairs = xp.asarray(product(degree), dtype=total.dtype)
    turn = cross_product(com.constant[..., :, None, :], pull.constant[..., None, :, :])
    slope = (
        pull.share[..., None, :, None] * com.constant[..., :, None, :]
        - com.share[..., :, None, None] * pull.constant[..., None, :, :]
    )
    turn, slope = (xp.einsum("mij,...ijc->...mc", pairs, each) for each in (turn, slope))
    raised = xp.asarray(elevation(degree - 2, 2 * degree - 3), dtype=total.dtype)
    push = pull.through(raised)
    joined = [AffinePoints(_join(p.constant, 3), _join(p.share, 2)) for p in (com, pull, push)]
    return joined[0], joined[1], joined[2], (_join(turn, 3), _join(slope, 3))


def _per_phase(points: AffinePoints) -> AffinePoints:
    return AffinePoints(points.constant[..., None, :, :], points.share[..., None, :])


def _over_weight(acceleration: AffinePoints, lift: Numbers) -> AffinePoints:
    return AffinePoints(acceleration.constant / GRAVITY + lift, acceleration.share / GRAVITY)


def _join(array: Numbers, axes: int) -> Numbers:
    """Join the pieces of a phase, the first of the last `axes` axes, with the next axis."""
    shape = array.shape
    first = len(shape) - axes
    return array.reshape(*shape[:first], shape[first] * shape[first + 1], *shape[first + 2 :])


def _reach_rows(transitions: Transitions, origin: Numbers, com: AffinePoints) -> Rows:
    """Return the reach limits; instants share rows where the rows do not turn between them."""
    xp = namespace(origin)
    rows, bounds = transitions.reach
    from_origin = bounds - (rows * origin[..., None, None, None, :]).sum(axis=-1)
    slack = (
        from_origin - xp.einsum("...slc,...src->...slr", com.constant, rows[..., 0, :, :])
        if (rows.shape[-3] == 1)
        else from_origin - (rows * com.constant[..., None, :]).sum(axis=-1)
    )
    share = com.share
    if rows.shape[-3] == 1:
        return Rows(rows[..., 0, :, :] / REACH_UNIT, share, slack / REACH_UNIT)
    return Rows(
        _join(rows, 4) / REACH_UNIT,
        _join(share, 2)[..., None],
        _join(slack, 3)[..., None, :] / REACH_UNIT,
    )


def _acceleration_rows(pull: AffinePoints, most: Numbers) -> Rows:
    """Return the limits |c''| / gravity <= most, per axis."""
    xp = namespace(most)
    axes = xp.concatenate([xp.eye(3, dtype=most.dtype), -xp.eye(3, dtype=most.dtype)])
    lift = xp.asarray([0.0, 0.0, 1.0], dtype=most.dtype)
    constant = _join(pull.constant - lift, 3)
    bounds = most[..., None, None] - constant @ axes.T
    batch = most.shape
    return Rows(
        xp.broadcast_to(axes, (*batch, 1, 6, 3)),
        _join(pull.share, 2)[..., None, :],
        bounds[..., None, :, :],
    )
