"""Find the steering policy at a path: a run folder, a policy.npz, or an ONNX file."""

import logging
from collections.abc import Collection
from dataclasses import replace
from pathlib import Path

from jaxleas.conditions import STANDARD, harmless, permission, words_of
from jaxleas.envs.steering import SteeringConfig
from jaxleas.files import policy_path
from jaxleas.guide.onnx_policy import OnnxPolicy, read_onnx_policy
from jaxleas.runs import policy_file
from jaxleas.training import Policy, read_policy
from jaxleas.types import InputError

_LOG = logging.getLogger("jaxleas")


def load_policy(
    path: str | Path, allow: Collection[str] = (), guard: bool | None = None
) -> Policy | OnnxPolicy:
    """Return the policy at `path`; its `config` describes the environment to use it in.

    That is the environment it was trained in, with one exception: conditions that are code, or a
    surrogate's file, are loaded only if the user allows it, because a policy file may come from a
    stranger. Without them the policy walks under R* and C, and a warning says so.

    Args:
        path: run folder (its best policy, `RUN/policy.npz`), `policy.npz`, or `.onnx` file; or
            `pretrained:NAME`.
        allow: each MODULE:CLASS among the policy's conditions that the user has allowed.
        guard: whether its roll-outs are guarded; None: as its configuration states.

    Raises:
        InputError: there is no policy at the path, or it cannot be used.
    """
    policy = read_steering_policy(path)
    if guard is not None:
        watched = policy.config.guard.model_copy(update={"enabled": guard})
        policy = replace(policy, config=policy.config.model_copy(update={"guard": watched}))
    conditions = policy.config.conditions
    if harmless(conditions, allow):
        return policy
    _LOG.warning(
        "%s was trained under %s; it walks under %s%s",
        path,
        words_of(conditions),
        words_of(STANDARD),
        permission(conditions, allow),
    )
    return replace(policy, config=policy.config.under_standard_conditions())


def read_steering_policy(path: str | Path) -> Policy | OnnxPolicy:
    """Return the policy at `path`; its `config` names the conditions that it was trained under.

    Args:
        path: path of a run folder, a `policy.npz` or an `.onnx` file, or `pretrained:NAME`.

    Raises:
        InputError: there is no policy at the path, or it cannot be used.
    """
    path = policy_path(path)
    if path.is_dir():
        return read_policy(policy_file(path), of=SteeringConfig)
    if path.suffix == ".npz":
        return read_policy(path, of=SteeringConfig)
    if path.suffix == ".onnx":
        return read_onnx_policy(path)
    if not path.exists():
        raise InputError(f"{path} does not exist; a run folder, a policy.npz or an .onnx would do")
    raise InputError(f"{path} is not a policy: a run folder, a policy.npz or an .onnx would do")
