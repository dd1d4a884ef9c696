"""Find the policy a person means: a run folder, a policy.npz, or an ONNX file."""

from pathlib import Path

from jaxleas.guide.onnx_policy import OnnxPolicy, read_onnx_policy
from jaxleas.training.policy import SteeringPolicy, read_policy
from jaxleas.types import InputError


def load_policy(path: str | Path) -> SteeringPolicy | OnnxPolicy:
    """Return the policy at `path`; its `config` says what environment it was trained in.

    Args:
        path: a run folder (its best policy, `RUN/policy.npz`), a `policy.npz`, or an `.onnx`.

    Raises:
        InputError: there is none, or it cannot be used.
    """
    path = Path(path)
    if path.is_dir():
        return read_policy(policy_file(path))
    if path.suffix == ".npz":
        return read_policy(path)
    if path.suffix == ".onnx":
        return read_onnx_policy(path)
    if not path.exists():
        raise InputError(f"{path} does not exist; a run folder, a policy.npz or an .onnx would do")
    raise InputError(f"{path} is not a policy: a run folder, a policy.npz or an .onnx would do")


def policy_file(run: str | Path) -> Path:
    """Return the file of a run's best policy.

    Raises:
        InputError: the folder is missing, no run folder, half-written, or of another version.
    """
    from jaxleas.runs.folder import RunFolder

    folder = RunFolder.open(run, needs_checkpoint=False)
    file = folder.path / "policy.npz"
    if not file.is_file():
        raise InputError(
            f"the run folder {run} holds no policy.npz yet; go on with train.py --resume {run}"
        )
    return file
