"""Steps of training a second, end to end: fresh starts, walking, learning."""

from functools import partial

from jax import Array

from benchmarks.context import Context, changed
from benchmarks.measurements import Figure, Metric
from benchmarks.timing import seconds_a_call
from benchmarks.workloads.workload import Workload
from jaxleas.envs.steering.layout import ICRA81
from jaxleas.training.config import RunConfig
from jaxleas.training.loop import Trainer

SIZES = (256, 1024, 4096, 16_384, 65_536)
AS_SHIPPED, AGAINST_SIX = "ppo_as_shipped", "ppo_as_shipped_six_environments"


def _as_shipped(context: Context) -> dict[str, Figure]:
    runs, limit = _rates(context, context.config)
    return {
        AS_SHIPPED: Figure(runs, limit, context.rival.figure("batched")),
        # The same figure against the thesis's own set-up.
        AGAINST_SIX: Figure(runs, limit, context.rival.figure("six")),
    }


def _of_size(robots: int, context: Context) -> dict[str, Figure]:
    config = changed(context.config, ppo={"environments": robots})
    return {f"ppo_{robots}": _figure(context, config)}


def _icra81(context: Context) -> dict[str, Figure]:
    config = changed(context.config, env={"observation": ICRA81.name})
    # The rival was measured with the shipped observation: no ratio.
    return {"ppo_icra81": Figure(*_rates(context, config))}


def _figure(context: Context, config: RunConfig) -> Figure:
    return Figure(*_rates(context, config), context.rival.figure("batched"))


def _rates(context: Context, config: RunConfig) -> tuple[list[float], float]:
    """Return steps a second, one value a run, and their bound."""
    trainer = Trainer(config)
    held = [trainer.fresh_state()]

    def call() -> dict[str, Array]:
        held[0], metrics = trainer.train_step(trainer.world, held[0])
        return metrics

    seconds = seconds_a_call(call, context.runs)
    return [config.ppo.batch / each for each in seconds], context.ppo_limit(config, trainer.env)


TRAINING = (
    Workload((Metric(AS_SHIPPED, "steps/s"), Metric(AGAINST_SIX, "steps/s")), _as_shipped),
    Workload((Metric("ppo_icra81", "steps/s", quick=False),), _icra81),
    *(
        Workload((Metric(f"ppo_{robots}", "steps/s", quick=False),), partial(_of_size, robots))
        for robots in SIZES
    ),
)
