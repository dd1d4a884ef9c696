"""Policies, surrogates, checkpoints."""

from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np

from jaxleas.envs.steering.config import SteeringConfig
from jaxleas.envs.steering.layout import layout_named
from tests.robustness.hostile_files import binary_mutations as b
from tests.robustness.hostile_files.kinds import Kind, kind_of


def learned_kinds(folder: Path) -> list[Kind]:
    from jaxleas.export.onnx_file import build_onnx
    from jaxleas.export.write import described
    from jaxleas.guide.loading import load_policy
    from jaxleas.runs.checkpoints import Checkpoints
    from jaxleas.surrogates import Identity, Surrogate, read_surrogate, write_surrogate
    from jaxleas.surrogates.network import Weights
    from jaxleas.training.networks.mlp import Mlp, params_of
    from jaxleas.training.policy import Policy, write_policy

    config = SteeringConfig(observation="icra81")
    size, generator = layout_named(config.observation).size, np.random.default_rng(0)

    def some(*shape: int) -> jax.Array:
        return jnp.asarray(generator.normal(size=shape), jnp.float32)

    policy = Policy(
        mean=some(size),
        deviation=jnp.ones(size),
        params=params_of([(some(size, 6), some(6)), (some(6, 8), some(8))]),
        network=Mlp(size, (6,), 8, "relu"),
        signature=config.signature(),
        config=config,
    )
    write_policy(folder / "policy.npz", policy)
    (folder / "policy.onnx").write_bytes(build_onnx(policy, described(config)))
    identity = Identity.of("sampling", {"keep_every": 5, "samples": 100}, config)
    inputs, code, hidden = identity.inputs, 5, 4
    weights = Weights(
        encoder=some(inputs, code),
        encoder_bias=some(code),
        gates=some(code + hidden, 2 * hidden),
        gates_bias=some(2 * hidden),
        candidate=some(code + hidden, hidden),
        candidate_bias=some(hidden),
        head=some(hidden),
        head_bias=some(),
    )
    write_surrogate(
        folder / "surrogate.npz",
        Surrogate(weights, jnp.ones(()), jnp.zeros(()), identity, {"guides": {}}),
    )
    state = {
        "key": jax.random.key(0),
        "w": some(3, 2),
        "n": 3,
        "rate": 0.5,
        "half": some(2).astype(jnp.bfloat16),
    }
    checkpoints = Checkpoints(folder / "checkpoints")
    checkpoints.save(7, state, {"best": 0.5}, 0.5)
    (step,) = (folder / "checkpoints").glob("step_*.npz")

    def walk(path: Path) -> None:
        load_policy(path)(np.zeros((2, size), np.float32))  # type: ignore[arg-type]

    def restore(path: Path) -> None:
        found = Checkpoints(path.parent)
        found.latest(state)
        found.best(state)

    return [
        kind_of("policy", folder / "policy.npz", walk, b.mutate_npz),
        kind_of("ONNX policy", folder / "policy.onnx", walk, b.mutate_onnx),
        kind_of("surrogate", folder / "surrogate.npz", read_surrogate, b.mutate_npz),
        kind_of("checkpoint", step, restore, b.mutate_npz),
    ]
