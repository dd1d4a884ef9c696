"""Origin of a run: versions, git revision and changes, command, machine."""

import os
import platform
import subprocess
from collections.abc import Sequence
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import jax

_SOURCE = Path(__file__).resolve().parents[2]
_SECONDS = 10.0  # a git that takes longer (a network file system) is not worth waiting for


def collect_provenance(command: Sequence[str]) -> tuple[dict[str, Any], str]:
    """Return the provenance of this process as plain JSON values, and the uncommitted diff.

    Args:
        command: command line that started the run.

    Returns:
        The record, in which `git` is null where the package does not run from its repository; and
        the difference to the revision, empty if there is none.
    """
    git, diff = _git_state()
    record = {
        "jaxleas": _version("jaxleas"),
        "git": git,
        "command": list(command),
        "created": datetime.now(UTC).isoformat(timespec="seconds"),
        "python": platform.python_version(),
        "packages": {name: _version(name) for name in ("jax", "jaxlib", "brax", "flax", "optax")},
        "machine": {
            "system": platform.system(),
            "architecture": platform.machine(),
            "cores": os.cpu_count(),
            "devices": [device.device_kind for device in jax.devices()],
        },
    }
    return record, diff


def _git_state() -> tuple[dict[str, Any] | None, str]:
    # Installed inside another repository, the package is in a repository but not part of it.
    if _git("ls-files", "--error-unmatch", "jaxleas/__init__.py") is None:
        return None, ""
    revision = _git("rev-parse", "HEAD")
    if revision is None:  # no commit yet
        return None, ""
    diff = _git("diff", "HEAD", "--no-ext-diff", "--no-color") or ""
    untracked = (_git("ls-files", "--others", "--exclude-standard") or "").splitlines()
    state = {"revision": revision.strip(), "changed": bool(diff), "untracked": untracked[:100]}
    return state, diff


def _git(*arguments: str) -> str | None:
    """Return the output of a git command on the source tree; None if it fails."""
    try:
        done = subprocess.run(
            ["git", "-C", str(_SOURCE), *arguments],
            capture_output=True,
            timeout=_SECONDS,
            check=False,
            env={**os.environ, "GIT_OPTIONAL_LOCKS": "0"},  # never blocks the user's git
        )
    except (OSError, subprocess.TimeoutExpired):
        return None
    return done.stdout.decode(errors="replace") if done.returncode == 0 else None


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return "unknown"
