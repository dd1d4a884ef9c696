"""The function behind `jaxleas export`."""

from pathlib import Path
from typing import Any

from jaxleas.types import InputError

RECORDING_KEY = 20_221_128  # of the walks that are recorded: the same ones for the same policy


def export(run: Path, *, out: Path | None = None) -> None:
    """Export the best policy of a run as ONNX and StableHLO, compared with JAX first.

    Args:
        run: the run folder.
        out: folder for policy.onnx, policy.stablehlo and export.json; by default the run folder.
    """
    import jax

    from jaxleas.envs.steering.env import SteeringEnv
    from jaxleas.export.parity import record_observations
    from jaxleas.export.write import export_policy
    from jaxleas.guide.loading import policy_file
    from jaxleas.training.config import RunConfig
    from jaxleas.training.configuration import load_config, to_yaml
    from jaxleas.training.policy import read_policy
    from jaxleas.training.worlds import held_out_world

    folder = Path(run)
    if folder.is_file():
        raise InputError(f"{run} is a file; the run folder, as train.py writes it, would do")
    policy = read_policy(policy_file(folder))
    config = load_config(RunConfig, folder / "config.yaml")
    env = SteeringEnv(policy.config)
    observations = record_observations(
        policy, env, held_out_world(config), jax.random.key(RECORDING_KEY)
    )
    target = folder if out is None else Path(out)
    record = export_policy(policy, target, observations, to_yaml(config), success_of(folder))
    parity = record["parity"]
    print(
        f"{target}/policy.onnx and policy.stablehlo: within {parity['onnxruntime']:.1e} and"
        f" {parity['stablehlo']:.1e} of JAX on {parity['observations']} observations"
    )


def success_of(run: Path) -> list[dict[str, Any]] | None:
    """Return the cells of the run's verdict on the transitions suite, if it was judged."""
    from jaxleas.evaluation.examination import evaluation_file
    from jaxleas.files import read_json

    file = evaluation_file(run, "transitions")
    if not file.is_file():
        return None
    verdict = read_json(file)
    return verdict.get("cells") if isinstance(verdict, dict) else None
