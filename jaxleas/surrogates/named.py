"""Surrogates named in a configuration: `{surrogate: FILE}` among its conditions."""

from jaxleas.conditions import SurrogateSettings
from jaxleas.envs.steering import SteeringConfig
from jaxleas.files import require_digest
from jaxleas.surrogates.foresight import SurrogateForesight
from jaxleas.surrogates.surrogate_file import read_surrogate, require_fit


def foresight_of(settings: SurrogateSettings, env: SteeringConfig) -> SurrogateForesight:
    """Return the foresight that ends episodes where a surrogate's planner would fail.

    Args:
        settings: file and threshold of the surrogate.
        env: configuration of the environment that the surrogate must fit.

    Raises:
        InputError: the file is missing, has changed, is not a surrogate, or is for another robot or
            observation.
    """
    surrogate = read_surrogate(settings.surrogate)
    require_digest(settings.surrogate, settings.sha256)
    require_fit(surrogate, env, where=settings.surrogate)
    return SurrogateForesight(surrogate, settings.threshold, queue=True)
