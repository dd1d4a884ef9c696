"""Latency of the exported policy in onnxruntime, called as by a robot."""

from functools import partial

import jax
import numpy as np

from benchmarks.arithmetic import forward_flops, layers
from benchmarks.context import Context
from benchmarks.measurements import Figure, Metric
from benchmarks.timing import seconds_a_call
from benchmarks.workloads.workload import Workload
from jaxleas.envs.steering import ACTION_SIZE
from jaxleas.export import build_onnx, described
from jaxleas.guide import onnx_policy_from_bytes
from jaxleas.training import initial_normaliser, make_networks, policy_of

BATCHES = (1, 1024)


def _measure(batch: int, context: Context) -> dict[str, Figure]:
    env, network = context.env, context.config.network
    # Untrained: the values of the weights do not change the time.
    networks = make_networks(network, env.config.signature())
    params = networks.actor.init(jax.random.key(0))
    normaliser = initial_normaliser(network, networks.signature)
    policy = policy_of(networks, env.config, normaliser, params)
    exported = onnx_policy_from_bytes(build_onnx(policy, described(env.config)), "the benchmark's")
    random = np.random.default_rng(0)
    observation = random.uniform(-1, 1, (batch, env.layout.size)).astype(np.float32)
    seconds = seconds_a_call(lambda: exported(observation), context.runs)
    flops = batch * forward_flops(layers(env.layout.size, network.hidden, ACTION_SIZE))
    limit = 1e6 * flops / context.roofs.large_products("float32")
    return {
        f"export_latency_{batch}": Figure(
            [1e6 * each for each in seconds], limit, context.rival.figure(f"latency_{batch}")
        )
    }


EXPORT = tuple(
    Workload(
        (Metric(f"export_latency_{batch}", "us", better="lower", tolerance=0.15),),
        partial(_measure, batch),
    )
    for batch in BATCHES
)
