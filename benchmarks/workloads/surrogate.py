"""The cost of a surrogate that ends episodes, per environment step."""

import jax

from benchmarks.context import Context
from benchmarks.measurements import Figure, Metric
from benchmarks.workloads.environment import ARENA_ROBOTS, rates
from benchmarks.workloads.workload import Workload
from jaxleas.contacts import settings_from
from jaxleas.envs.steering import SteeringEnv
from jaxleas.surrogates import FitSettings, Identity, Surrogate, SurrogateForesight, initial_weights

PLANNER = "sampling"


def untrained_surrogate(env: SteeringEnv) -> Surrogate:
    """Return a surrogate of the default size, which costs as much as a fitted one."""
    fit = FitSettings()
    identity = Identity.of(PLANNER, settings_from(PLANNER).model_dump(mode="json"), env.config)
    one = jax.numpy.float32(1.0)
    weights = initial_weights(jax.random.key(0), identity.inputs, fit.code, fit.hidden)
    return Surrogate(weights=weights, scale=one, shift=0.0 * one, identity=identity)


def _measure(context: Context) -> dict[str, Figure]:
    foresight = SurrogateForesight(untrained_surrogate(context.env), queue=True)
    watched = SteeringEnv(context.config.env, foresight=foresight)
    alone, with_it = (
        rates(env, context.world, ARENA_ROBOTS, context) for env in (context.env, watched)
    )
    longer = [100.0 * (before / after - 1.0) for before, after in zip(alone, with_it, strict=True)]
    return {WITH_SURROGATE: Figure(with_it), LONGER: Figure(longer)}


WITH_SURROGATE = f"env_with_surrogate_{ARENA_ROBOTS}"
LONGER = "env_surrogate_share"
SURROGATE = Workload(
    (
        Metric(WITH_SURROGATE, "steps/s"),
        Metric(LONGER, "% longer", better="lower", tolerance=0.3),
    ),
    _measure,
)
