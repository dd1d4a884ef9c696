"""The host is never more than some updates ahead of the devices: XLA:CPU hangs where it is."""

from types import SimpleNamespace

import jax
import jax.numpy as jnp

from jaxleas.training import loop
from tests.training.runs import tiny


def test_the_host_waits_before_it_is_too_far_ahead(monkeypatch):
    config = tiny(steps=64 * 10 * 40)
    config = config.model_copy(
        update={"held_out": config.held_out.model_copy(update={"every": 1000})}
    )
    assert config.ppo.updates >= 3 * loop.MOST_AHEAD
    begun, waited, ahead = [], [0], []

    def step(world, state):
        begun.append(len(begun) + 1)
        ahead.append(begun[-1] - waited[-1])
        return state, {"update": jnp.int32(begun[-1])}

    def wait(metrics):
        waited.append(int(metrics["update"]))

    monkeypatch.setattr(jax, "block_until_ready", wait)
    trainer = SimpleNamespace(
        config=config,
        world=None,
        held_out=None,
        train_step=step,
        examine=lambda *_: {"held_out/reached": 0.0},
        gather=lambda state: state,
    )
    state = SimpleNamespace(update=0, normaliser=None, averaged=None)
    interruption = SimpleNamespace(requested=False)
    loop._Session(trainer, interruption, None).run(state)  # type: ignore[arg-type]
    assert len(begun) == config.ppo.updates
    assert max(ahead) == loop.MOST_AHEAD
