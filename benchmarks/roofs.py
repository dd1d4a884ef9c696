"""The machine's roofs, measured in the same run: matrix products, memory, gathers."""

from collections.abc import Callable
from functools import partial

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from benchmarks.arithmetic import LOGITS, Rates, gradient_flops, layers
from benchmarks.spread import all_devices
from benchmarks.timing import seconds_a_call
from jaxleas.envs.steering import SteeringEnv
from jaxleas.terrain import Atlas
from jaxleas.training import AnyRun, Devices

LARGE = 2048  # side of the large matrices
PASSES = 8  # passes over memory in one call, so that the start of the call does not count
RUNS = 3


class Roofs:
    """The machine's roofs, each measured once, on first use.

    Args:
        atlas: atlas to gather heights from.
    """

    def __init__(self, atlas: Atlas) -> None:
        self._atlas = atlas
        self._known: dict[tuple[object, ...], float] = {}

    def rates(self, config: AnyRun, env: SteeringEnv, robots: int, matrix: bool) -> Rates:
        """Return the machine's rates at given sizes.

        Args:
            config: configuration of the training, whose networks' products are measured.
            env: environment of the task, whose gather is measured.
            robots: number of environments, which determines what fits into a cache.
            matrix: whether the rate of products is needed (it is infinite otherwise).
        """
        words = robots * (len(env.points_in_root) + env.layout.size)
        fastest = float("inf")
        if matrix:
            large = self.large_products(config.network.product_type)
            fastest = max(large, self.network_products(config, env))
        return Rates(
            matrix=fastest,
            memory=self.memory(words),
            gather=self.gather(env, robots),
        )

    def large_products(self, numbers: str) -> float:
        """Return the rate of large matrix products in a number format [FLOP/s]."""
        return self._once(("large", numbers), lambda: _large_products(numbers))

    def network_products(self, config: AnyRun, env: SteeringEnv) -> float:
        """Return the rate of only the products of one minibatch's gradient."""
        samples = config.ppo.batch // config.ppo.minibatches
        sizes = (samples, env.layout.size, *config.network.hidden)
        numbers = config.network.product_type
        return self._once(("network", numbers, *sizes), lambda: _network_products(numbers, *sizes))

    def memory(self, words: int) -> float:
        """Return the bandwidth over an array of a number of four-byte words [B/s]."""
        return self._once(("memory", words), lambda: _memory(words))

    def gather(self, env: SteeringEnv, robots: int) -> float:
        """Return the heights per second that are gathered under a number of robots."""
        key = ("gather", env.layout.name, robots)
        return self._once(key, lambda: _gather(self._atlas, env, robots))

    def _once(self, key: tuple[object, ...], measure: Callable[[], float]) -> float:
        if key not in self._known:
            self._known[key] = measure()
        return self._known[key]


def _seconds(call: Callable[[], Array]) -> float:
    # The fastest run: a roof is what the machine can do, not what it usually does.
    return min(seconds_a_call(call, RUNS, least_seconds=0.3))


def _normal(numbers: str, seed: int, *shape: int) -> Array:
    return jax.random.normal(jax.random.key(seed), shape, dtype=jnp.float32).astype(numbers)


def _by_all_devices(rate: Callable[[Devices], float]) -> float:
    """Return the better of the rates of one device and of all devices, each with its own part."""
    every = Devices.of(jax.devices())
    return max(rate(Devices.of(jax.devices()[:1])), rate(every) if len(every) > 1 else 0.0)


def _product(numbers: str) -> Callable[[Array, Array], Array]:
    # A processor sums bfloat16 in float32 (`jaxleas.training.networks`).
    sums = "float32" if jax.default_backend() == "cpu" else numbers
    return partial(jnp.matmul, preferred_element_type=sums)


def _large_products(numbers: str) -> float:
    def rate(devices: Devices) -> float:
        shape = (len(devices), LARGE, LARGE)
        operands = _normal(numbers, 0, *shape), _normal(numbers, 1, *shape)
        left, right = jax.device_put(operands, devices.divided)
        product = jax.jit(_product(numbers))
        return len(devices) * 2.0 * LARGE**3 / _seconds(lambda: product(left, right))

    return _by_all_devices(rate)


def _network_products(numbers: str, samples: int, inputs: int, *hidden: int) -> float:
    """Time three products per layer, operands ready: forward, weights' and inputs' gradients."""
    networks = [layers(inputs, hidden, outputs) for outputs in (LOGITS, 1)]
    flops = samples * sum(gradient_flops(network) for network in networks)
    return _by_all_devices(lambda devices: flops / _products(numbers, networks, samples, devices))


def _products(
    numbers: str, networks: list[list[tuple[int, int]]], samples: int, devices: Devices
) -> float:
    """Return the seconds of the products of one minibatch, divided among devices."""
    count = len(devices)
    operands, needed = [], []
    for network in networks:
        for index, (rows, columns) in enumerate(network):
            values = (
                _normal(numbers, 2, count, samples // count, rows),
                _normal(numbers, 3, count, rows, columns),
                _normal(numbers, 4, count, samples // count, columns),
                _normal(numbers, 5, count, rows, samples // count),
                _normal(numbers, 6, count, columns, rows),
            )
            operands.append(values)
            needed.append(index > 0)
    arrays = jax.device_put(operands, devices.divided)
    by = _product(numbers)

    @jax.jit
    def products(arrays):
        results = []
        for each, input_gradient in zip(arrays, needed, strict=True):
            value, kernel, gradient, turned_value, turned_kernel = each
            results += [by(value, kernel), by(turned_value, gradient)]
            if input_gradient:
                results.append(by(gradient, turned_kernel))
        return results

    return _seconds(lambda: products(arrays))


def _memory(words: int) -> float:
    shift = jax.jit(
        lambda array: jax.lax.fori_loop(0, PASSES, lambda _, carry: carry + 1.0, array),
        donate_argnums=0,
    )
    held = [jax.device_put(jnp.zeros(words, dtype=jnp.float32), all_devices(words).divided)]

    def call() -> Array:
        held[0] = shift(held[0])
        return held[0]

    return 2.0 * 4.0 * words * PASSES / _seconds(call)


def _gather(atlas: Atlas, env: SteeringEnv, robots: int) -> float:
    """Gather heights under robots spread over the atlas, their indices ready."""
    devices = all_devices(robots)
    index = jax.device_put(_height_indices(atlas, env, robots), devices.divided)
    flat = jax.device_put(atlas.heights.reshape(-1), devices.whole)

    @partial(jax.jit, donate_argnums=2)
    def gather(flat, index, heights):
        def once(number, _):
            return flat.at[index + number].get(mode="promise_in_bounds")

        return jax.lax.fori_loop(0, PASSES, once, heights)

    held = [jnp.zeros_like(index, dtype=jnp.float32)]

    def call() -> Array:
        held[0] = gather(flat, index, held[0])
        return held[0]

    return PASSES * index.size / _seconds(call)


def _height_indices(atlas: Atlas, env: SteeringEnv, robots: int) -> Array:
    """Return the indices, in the flat atlas, of the points of robots at random places."""
    random = np.random.default_rng(0)
    maps, rows, columns = atlas.heights.shape
    yaw = random.uniform(-np.pi, np.pi, (robots, 1))
    ahead, left = env.points_in_root.T
    x = (np.cos(yaw) * ahead - np.sin(yaw) * left) / atlas.resolution
    y = (np.sin(yaw) * ahead + np.cos(yaw) * left) / atlas.resolution
    column = np.clip(x + random.uniform(0, columns, (robots, 1)), 0, columns - 1).astype(np.int32)
    row = np.clip(y + random.uniform(0, rows, (robots, 1)), 0, rows - 1).astype(np.int32)
    index = (random.integers(0, maps, (robots, 1)) * rows + row) * columns + column
    return jnp.asarray(np.minimum(index, maps * rows * columns - PASSES), dtype=jnp.int32)
