"""Averages over the robots of all devices that share a training."""

from collections.abc import Collection
from dataclasses import dataclass

import jax
import jax.numpy as jnp
from jax import Array
from jaxtyping import Float


@dataclass(frozen=True)
class Average:
    """Averages of what every device computed from an equal share of the robots.

    Attributes:
        axis: name of the axis along which the devices lie; None: there is only one device.
    """

    axis: str | None = None

    def mean(self, each: Array) -> Array:
        """Return the mean over the devices."""
        return each if self.axis is None else jax.lax.pmean(each, self.axis)

    def standardised(self, values: Float[Array, "*batch"]) -> Float[Array, "*batch"]:
        """Return the values minus their mean, divided by their standard deviation."""
        mean, variance = jnp.mean(values), jnp.var(values)
        if self.axis is not None:
            whole, square, within = self.mean(jnp.stack([mean, mean * mean, variance]))
            mean, variance = whole, within + jnp.maximum(square - whole * whole, 0.0)
        return (values - mean) / (jnp.sqrt(variance) + 1e-8)

    def metrics(
        self, metrics: dict[str, Array], largest: Collection[str], smallest: Collection[str]
    ) -> dict[str, Array]:
        """Return the metrics of all robots.

        Args:
            metrics: metrics of this device's robots, by name.
            largest: names of those of which the largest counts.
            smallest: names of those of which the smallest counts; all others are averaged.
        """
        if self.axis is None:
            return metrics
        names = sorted(metrics)
        means = self.mean(jnp.stack([metrics[name] for name in names]))
        whole = dict(zip(names, means, strict=True))
        for name in names:
            if name in largest:
                whole[name] = jax.lax.pmax(metrics[name], self.axis)
            if name in smallest:
                whole[name] = jax.lax.pmin(metrics[name], self.axis)
        return whole


ONE_DEVICE = Average()
