"""Training steps per second, end to end (fresh starts, walking, learning), and their memory.

Each quantity grows alone, all else as shipped: robots, observation, arenas, networks.
"""

from functools import partial

import jax
from jax import Array

from benchmarks.context import Context, changed
from benchmarks.measurements import Figure, Metric
from benchmarks.timing import not_far_ahead, seconds_a_call
from benchmarks.workloads.workload import Workload
from jaxleas.envs.steering import ICRA81, SteeringEnv
from jaxleas.training import AnyRun, Trainer, choose_devices, make_task

SIZES = (256, 1024, 4096, 16_384, 65_536)
ARENAS = (16, 256)
WIDTHS = (64, 256, 512)  # of the first hidden layer; each further layer has half the width
AS_SHIPPED, AGAINST_SIX = "ppo_as_shipped", "ppo_as_shipped_six_environments"
MEMORY_TOLERANCE = 0.02  # the compiler's own count, which does not vary


def _as_shipped(context: Context) -> dict[str, Figure]:
    figures = _measure(AS_SHIPPED, context.config, context, rival="batched")
    speed = figures[AS_SHIPPED]
    # The same figure against the thesis's own set-up.
    return figures | {AGAINST_SIX: Figure(speed.runs, speed.limit, context.rival.figure("six"))}


def _of_size(robots: int, context: Context) -> dict[str, Figure]:
    config = changed(context.config, ppo={"environments": robots})
    return _measure(f"ppo_{robots}", config, context, rival="batched")


def _icra81(context: Context) -> dict[str, Figure]:
    config = changed(context.config, env={"observation": ICRA81.name})
    # The rival was measured with the shipped observation: no ratio.
    return _measure("ppo_icra81", config, context)


def _of_arenas(arenas: int, context: Context) -> dict[str, Figure]:
    config = changed(context.config, terrain={"arenas": arenas})
    # The roofs were measured over the shipped terrain: no limit.
    return _measure(f"ppo_arenas_{arenas}", config, context, limited=False)


def _of_width(width: int, context: Context) -> dict[str, Figure]:
    hidden = tuple(width >> layer for layer in range(len(context.config.network.hidden)))
    config = changed(context.config, network={"hidden": hidden})
    return _measure(f"ppo_width_{width}", config, context)


def _measure(
    name: str,
    config: AnyRun,
    context: Context,
    rival: str | None = None,
    limited: bool = True,
) -> dict[str, Figure]:
    """Return the steps per second, and the memory of the compiled step [MiB]."""
    devices = choose_devices("all", config.ppo)
    trainer = Trainer(config, make_task(config), devices)
    held = [trainer.fresh_state()]
    step = trainer.train_step.lower(trainer.world, held[0]).compile()  # type: ignore[attr-defined]

    def call() -> dict[str, Array]:
        held[0], metrics = step(trainer.world, held[0])
        return metrics

    seconds = seconds_a_call(not_far_ahead(call), context.runs)
    speed = Figure(
        [config.ppo.batch / each for each in seconds],
        context.ppo_limit(config, SteeringEnv(config.env)) if limited else None,
        context.rival.figure(rival) if rival else None,
    )
    each = step_memory(step)
    # The compiler counts for one device; cores share one memory.
    sharing = len(devices) if jax.default_backend() == "cpu" else 1
    return {name: speed, memory_name(name): Figure([None if each is None else sharing * each])}


def memory_name(name: str) -> str:
    """Return the name of the memory metric of a training."""
    return name.replace("ppo_", "ppo_memory_", 1)


def step_memory(step: jax.stages.Compiled) -> float | None:
    """Return the memory of a compiled step on a device: terrain, state, batch, temporaries [MiB].

    It is None if the device's compiler does not count it.
    """
    sizes = step.memory_analysis()
    if sizes is None:
        return None
    held = sizes.argument_size_in_bytes + sizes.temp_size_in_bytes
    return (held + sizes.output_size_in_bytes - sizes.alias_size_in_bytes) / 2**20


def _metrics(name: str, quick: bool = False) -> tuple[Metric, Metric]:
    return (
        Metric(name, "steps/s", quick=quick),
        Metric(memory_name(name), "MiB", "lower", tolerance=MEMORY_TOLERANCE, quick=quick),
    )


TRAINING = (
    Workload((*_metrics(AS_SHIPPED, quick=True), Metric(AGAINST_SIX, "steps/s")), _as_shipped),
    Workload(_metrics("ppo_icra81"), _icra81),
    *(Workload(_metrics(f"ppo_{each}"), partial(_of_size, each)) for each in SIZES),
    *(Workload(_metrics(f"ppo_arenas_{each}"), partial(_of_arenas, each)) for each in ARENAS),
    *(Workload(_metrics(f"ppo_width_{each}"), partial(_of_width, each)) for each in WIDTHS),
)
