"""How many of a processor's cores share a training."""

import pytest

from jaxleas.training import processor
from jaxleas.training.config import PpoConfig


@pytest.mark.parametrize(
    ("there", "robots", "sharing"),
    [(1, 128, 1), (2, 128, 2), (6, 128, 4), (64, 128, 8), (3, 48, 3), (8, 17, 1), (8, 4, 1)],
)
def test_cores_share_a_minibatch_evenly_and_have_sixteen_robots_each(
    there, robots, sharing, monkeypatch
):
    monkeypatch.setattr(processor, "cores", lambda: there)
    ppo = PpoConfig(environments=4 * robots, minibatches=4)
    assert processor.cores_that_share(ppo) == sharing


@pytest.mark.parametrize("chosen", ["JAX_NUM_CPU_DEVICES", "XLA_FLAGS"])
def test_a_number_that_the_user_has_chosen_stays(chosen, monkeypatch):
    monkeypatch.setenv(chosen, "--xla_force_host_platform_device_count=3")
    monkeypatch.setattr("jax.config.update", lambda *_: pytest.fail("it was changed"))
    processor.use_cores(2)
