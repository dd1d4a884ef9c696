"""The machine's roofs, so that a slow machine is not mistaken for slow code."""

from benchmarks.context import Context
from benchmarks.measurements import Figure, Metric
from benchmarks.workloads.workload import Workload

ROBOTS = 4096


def _gather(context: Context) -> dict[str, Figure]:
    rates = context.roofs.rates(context.config, context.env, ROBOTS, matrix=False)
    return {
        "env_roof_gather": Figure([rates.gather / 1e9]),
        "env_roof_memory": Figure([rates.memory / 1e9]),
    }


def _products(context: Context) -> dict[str, Figure]:
    roofs, numbers = context.roofs, context.config.network.product_type
    return {
        "ppo_roof_large_products": Figure([roofs.large_products(numbers) / 1e9]),
        "ppo_roof_network_products": Figure(
            [roofs.network_products(context.config, context.env) / 1e9],
            limit=roofs.large_products(numbers) / 1e9,
        ),
    }


MACHINE = (
    Workload(
        (Metric("env_roof_gather", "G heights/s"), Metric("env_roof_memory", "GB/s")), _gather
    ),
    Workload(
        (
            Metric("ppo_roof_large_products", "GFLOP/s"),
            Metric("ppo_roof_network_products", "GFLOP/s"),
        ),
        _products,
    ),
)
