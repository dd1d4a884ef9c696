"""Find the steering policy a person means: a run folder, a policy.npz, or an ONNX file."""

from pathlib import Path

from jaxleas.envs.steering.config import SteeringConfig
from jaxleas.guide.onnx_policy import OnnxPolicy, read_onnx_policy
from jaxleas.runs.folder import policy_file
from jaxleas.training.policy import Policy, read_policy
from jaxleas.types import InputError


def load_policy(path: str | Path) -> Policy | OnnxPolicy:
    """Return the policy at `path`; its `config` says what environment it was trained in.

    Args:
        path: a run folder (its best policy, `RUN/policy.npz`), a `policy.npz`, or an `.onnx`.

    Raises:
        InputError: there is none, or it cannot be used.
    """
    path = Path(path)
    if path.is_dir():
        return read_policy(policy_file(path), of=SteeringConfig)
    if path.suffix == ".npz":
        return read_policy(path, of=SteeringConfig)
    if path.suffix == ".onnx":
        return read_onnx_policy(path)
    if not path.exists():
        raise InputError(f"{path} does not exist; a run folder, a policy.npz or an .onnx would do")
    raise InputError(f"{path} is not a policy: a run folder, a policy.npz or an .onnx would do")
