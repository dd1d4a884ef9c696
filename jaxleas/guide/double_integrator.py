"""Double integrators in minimum time: the closed form behind RB-Kino.

Source: T. Kunz and M. Stilman, Probabilistically complete kinodynamic planning for robot
manipulators with acceleration limits, IROS 2014; P. Fernbach et al., A kinodynamic steering-method
for legged multi-contact locomotion, IROS 2017. Below, d is the displacement, v_1 and v_2 the
velocities at both ends, A and V the bounds of |acceleration| and |velocity|, all of one axis.
"""

import jax.numpy as jnp
from flax import struct
from jax import Array
from jaxtyping import Float

_TINY = 1e-30  # keeps 0 / 0 out of branches that are not taken


@struct.dataclass
class Connection:
    """A motion between two states: every axis arrives at `duration`.

    Each axis accelerates, keeps its speed, and then accelerates as much in the opposite direction.

    Attributes:
        duration: duration of the motion [s].
        displacement: displacement to be covered [m].
        start_velocity: v_1 [m/s].
        end_velocity: v_2 [m/s].
        acceleration: acceleration of the first stretch; the last stretch has its negative [m/s^2].
        first: duration of the first stretch [s].
        last: duration of the last stretch [s].
    """

    duration: Float[Array, "*batch"]
    displacement: Float[Array, "*batch axes"]
    start_velocity: Float[Array, "*batch axes"]
    end_velocity: Float[Array, "*batch axes"]
    acceleration: Float[Array, "*batch axes"]
    first: Float[Array, "*batch axes"]
    last: Float[Array, "*batch axes"]

    def at(
        self, time: Float[Array, "*batch"]
    ) -> tuple[Float[Array, "*batch axes"], Float[Array, "*batch axes"]]:
        """Return displacement so far [m] and velocity [m/s]; after the end, those at the end.

        Args:
            time: time since the start [s].
        """
        time, duration = time[..., None], self.duration[..., None]
        to_end = jnp.maximum(duration - time, 0.0)
        begun = jnp.minimum(time, self.first)
        ending = jnp.minimum(to_end, self.last)
        # The motion is computed from the start, the last stretch back from the end: rounding
        # then moves the middle and leaves both ends exact.
        velocity = self.start_velocity + self.acceleration * begun
        covered = self.start_velocity * begun + 0.5 * self.acceleration * begun * begun
        covered = covered + velocity * jnp.maximum(time - begun, 0.0)
        left = self.end_velocity * ending + 0.5 * self.acceleration * ending * ending
        late = to_end < self.last
        covered = jnp.where(late, self.displacement - left, covered)
        velocity = jnp.where(late, self.end_velocity + self.acceleration * ending, velocity)
        over = time >= duration
        return jnp.where(over, self.displacement, covered), jnp.where(
            over, self.end_velocity, velocity
        )


def connect(
    displacement: Float[Array, "*batch axes"],
    start_velocity: Float[Array, "*batch axes"],
    end_velocity: Float[Array, "*batch axes"],
    max_velocity: Float[Array, "*batch axes"],
    max_acceleration: Float[Array, "*batch axes"],
) -> Connection:
    """Return the motion of the least duration that all axes can make together.

    The duration is the least that is possible for every axis: that of the slowest, unless it
    falls into another's gap (`axis_times`). Each axis then moves with the least acceleration that
    arrives on time.

    Args:
        displacement: d [m].
        start_velocity: v_1 [m/s], within the bounds.
        end_velocity: v_2 [m/s], within the bounds.
        max_velocity: V [m/s], above 0.
        max_acceleration: A [m/s^2], above 0.
    """
    least, gap_begin, gap_end = axis_times(
        displacement, start_velocity, end_velocity, max_velocity, max_acceleration
    )
    duration = jnp.max(least, axis=-1, keepdims=True)
    for _ in range(displacement.shape[-1]):  # leaving one gap may lead into the next
        inside = (duration > gap_begin) & (duration < gap_end)
        duration = jnp.max(jnp.where(inside, gap_end, duration), axis=-1, keepdims=True)
    return _stretched(duration, displacement, start_velocity, end_velocity, max_velocity)


def axis_times(
    displacement: Float[Array, "*batch"],
    start_velocity: Float[Array, "*batch"],
    end_velocity: Float[Array, "*batch"],
    max_velocity: Float[Array, "*batch"],
    max_acceleration: Float[Array, "*batch"],
) -> tuple[Float[Array, "*batch"], Float[Array, "*batch"], Float[Array, "*batch"]]:
    """Return which durations are possible for one axis: all from `least` on, except for one gap.

    Seen so that d is at least the d_0 of changing from v_1 to v_2 at once, the fastest motion peaks
    at u = sqrt(A d + (v_1^2 + v_2^2) / 2), or cruises at V:

        least = (2 u - v_1 - v_2) / A,   or   (2 V - v_1 - v_2) / A + (d - d_V) / V,

    d_V = (2 V^2 - v_1^2 - v_2^2) / 2 A. An axis that moves forward at both ends cannot take just
    any longer time: once it cannot be slower it must go back and come again. With
    w = sqrt((v_1^2 + v_2^2) / 2 - A d) the gap lies between (v_1 + v_2 -+ 2 w) / A.

    Returns:
        The least duration, the beginning and the end of the gap [s] (both 0 without a gap).
    """
    ramp = jnp.abs(end_velocity - start_velocity) / max_acceleration
    excess = displacement - 0.5 * (start_velocity + end_velocity) * ramp
    sign = jnp.where(excess >= 0.0, 1.0, -1.0)
    forward, begin, end = sign * displacement, sign * start_velocity, sign * end_velocity
    total, square = begin + end, 0.5 * (begin * begin + end * end)

    peak = jnp.sqrt(jnp.maximum(max_acceleration * forward + square, 0.0))
    # Rounding must not put the peak below the faster end, nor turn a motion that just suffices into
    # one that goes back and comes again.
    peak = jnp.maximum(peak, jnp.maximum(begin, end))
    cruise_from = (max_velocity * max_velocity - square) / max_acceleration
    cruise = jnp.maximum(forward - cruise_from, 0.0) / max_velocity
    least = (2.0 * jnp.minimum(peak, max_velocity) - total) / max_acceleration + cruise
    least = jnp.where(excess == 0.0, ramp, least)

    under = square - max_acceleration * forward
    has_gap = (under > 0.0) & (jnp.minimum(begin, end) > 0.0) & (excess != 0.0)
    half = 2.0 * jnp.sqrt(jnp.where(has_gap, under, 0.0))
    gap_begin = jnp.where(has_gap, (total - half) / max_acceleration, 0.0)
    gap_end = jnp.where(has_gap, (total + half) / max_acceleration, 0.0)
    return least, gap_begin, gap_end


def _stretched(
    duration: Float[Array, "*batch 1"],
    displacement: Float[Array, "*batch axes"],
    start_velocity: Float[Array, "*batch axes"],
    end_velocity: Float[Array, "*batch axes"],
    max_velocity: Float[Array, "*batch axes"],
) -> Connection:
    """Return each axis's motion of least acceleration a in a possible duration T.

    With b = |2 d - (v_1 + v_2) T|: a = (b + sqrt(b^2 + T^2 (v_2 - v_1)^2)) / T^2; where its peak
    (v_1 + v_2 + a T) / 2 exceeds V, a = ((V - v_1)^2 + (V - v_2)^2) / (2 (V T - d)).
    """
    time = jnp.maximum(duration, _TINY)
    deviation = 2.0 * displacement - (start_velocity + end_velocity) * time
    sign = jnp.where(deviation >= 0.0, 1.0, -1.0)
    forward, begin, end = sign * displacement, sign * start_velocity, sign * end_velocity
    excess, change = jnp.abs(deviation) / time, end - begin
    acceleration = (excess + jnp.sqrt(excess * excess + change * change)) / time
    peak = 0.5 * (begin + end + acceleration * time)
    cruises = peak > max_velocity
    room = jnp.maximum(max_velocity * time - forward, _TINY)
    to_limit = (max_velocity - begin) ** 2 + (max_velocity - end) ** 2
    acceleration = jnp.where(cruises, 0.5 * to_limit / room, acceleration)
    peak = jnp.minimum(peak, max_velocity)
    divisor = jnp.maximum(acceleration, _TINY)
    first = jnp.clip((peak - begin) / divisor, 0.0, duration)
    last = jnp.clip((peak - end) / divisor, 0.0, duration - first)
    return Connection(
        duration=duration[..., 0],
        displacement=displacement,
        start_velocity=start_velocity,
        end_velocity=end_velocity,
        acceleration=sign * acceleration,
        first=first,
        last=last,
    )
