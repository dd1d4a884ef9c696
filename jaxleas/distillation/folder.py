"""A distillation's folder: what each round leaves behind, and so how far it has come.

config.yaml             the resolved configuration
begun_with.json         where the policy to begin with lies
start/                  run folder of the policy to begin with, where none was given
round_<k>/labels/       scenes, guide paths and verdicts
round_<k>/surrogate.npz fitted to the verdicts of all rounds so far
round_<k>/run/          run folder of the policy's practice
round_<k>/policy.npz    what practice ended with
round_<k>/judged.json   the exact planner's verdicts on its policy; round_0 is the one begun with
rounds.json             the table of all rounds
policy.npz, surrogate.npz   of the best round

Every file is whole or absent, and each stage is done when its last file is there: a distillation
that was killed at any moment resumes from the stage it was in.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from jaxleas.files import read_json, require_version
from jaxleas.runs import POLICY_FILE
from jaxleas.types import InputError

CONFIG = "config.yaml"
VERSION = 1  # of the whole folder


def read_done(path: Path, *keys: str) -> dict[str, Any]:
    """Read what a stage wrote when it was done.

    Raises:
        InputError: a key is missing, or holds no number.
    """
    content = read_json(path)
    for key in keys:
        if not isinstance(content, dict) or type(content.get(key)) not in (int, float):
            raise InputError(f"{path} does not say {key}, a number; without it, it is done again")
    return content


def read_begun_with(path: Path) -> str | None:
    """Return the run folder of the policy that a distillation began with; None: its own.

    Raises:
        InputError: the file does not contain it.
    """
    content = read_json(path)
    if not isinstance(content, dict) or not isinstance(content.get("run", 0), str | None):
        raise InputError(f"{path} does not say what the distillation was begun with")
    require_version(content, VERSION, path)
    return content["run"]


@dataclass(frozen=True)
class RoundFolder:
    """One round's part of the folder."""

    path: Path

    @property
    def labels(self) -> Path:
        """Return the folder of scenes, guide paths and verdicts."""
        return self.path / "labels"

    @property
    def labelled(self) -> Path:
        """Return the file written when every guide path has its verdict: how long it took."""
        return self.labels / "done.json"

    @property
    def surrogate(self) -> Path:
        """Return the file of the surrogate."""
        return self.path / "surrogate.npz"

    @property
    def run(self) -> Path:
        """Return the run folder of the practice."""
        return self.path / "run"

    @property
    def policy(self) -> Path:
        """Return the file of the policy that practice ended with."""
        return self.path / POLICY_FILE

    @property
    def practised(self) -> Path:
        """Return the file written when the practice is over: how long it took."""
        return self.path / "practised.json"

    @property
    def judged(self) -> Path:
        """Return the file of the exact planner's verdicts."""
        return self.path / "judged.json"


@dataclass(frozen=True)
class DistillationFolder:
    """The whole folder."""

    path: Path

    @property
    def config(self) -> Path:
        """Return the file of the resolved configuration."""
        return self.path / CONFIG

    @property
    def begun_with(self) -> Path:
        """Return the file that names the policy to begin with."""
        return self.path / "begun_with.json"

    @property
    def start(self) -> Path:
        """Return the run folder of the policy to begin with, where none was given."""
        return self.path / "start"

    @property
    def table(self) -> Path:
        """Return the file of the table of all rounds."""
        return self.path / "rounds.json"

    @property
    def policy(self) -> Path:
        """Return the file of the best round's policy."""
        return self.path / POLICY_FILE

    @property
    def surrogate(self) -> Path:
        """Return the file of the best round's surrogate."""
        return self.path / "surrogate.npz"

    def round(self, number: int) -> RoundFolder:
        """Return one round's part of the folder; round 0 is the policy begun with."""
        return RoundFolder(self.path / f"round_{number}")
