"""A run folder: all files of one training, held by one writer at a time.

config.yaml       the resolved configuration
provenance.json   format, versions, git revision, command, machine
provenance.diff   uncommitted changes, if there were any
metrics.jsonl     one JSON object per line
tensorboard/      the same for TensorBoard
checkpoints/      the last few full states and the best
lock              held while a process writes
"""

from collections.abc import Sequence
from pathlib import Path
from types import TracebackType
from typing import Self

from jaxleas.files import FolderLock, read_json, sweep_temporaries, write_json, write_text
from jaxleas.runs.provenance import collect_provenance
from jaxleas.types import InputError

FORMAT = 1
POLICY_FILE = "policy.npz"
"""Name of the file with a run's best policy."""


class RunFolder:
    """The folder of a run; make it with `create` or `open`, and `close` it to let others write.

    Attributes:
        path: path of the folder.
    """

    def __init__(self, path: Path, lock: FolderLock | None) -> None:
        self.path = path
        self._lock = lock

    @classmethod
    def create(cls, path: str | Path, config_yaml: str, command: Sequence[str]) -> Self:
        """Make the folder of a new run and hold it for writing.

        Args:
            path: path of a folder that does not exist, or is empty.
            config_yaml: resolved configuration.
            command: command line that started the run.

        Raises:
            InputError: the folder is taken, in use, or cannot be written.
        """
        path = Path(path)
        try:
            path.mkdir(parents=True, exist_ok=True)
            _require_vacant(path)
            lock = _take_lock(path)
            try:
                _require_vacant(path)  # again, now that no other process can fill it
                run = cls(path, lock)
                run._write_records(config_yaml, command)
            except BaseException:
                lock.close()
                raise
        except OSError as error:
            raise InputError(
                f"cannot make the run folder {path}: {error.strerror or error}"
            ) from error
        return run

    @classmethod
    def open(cls, path: str | Path, writing: bool = False, needs_checkpoint: bool = True) -> Self:
        """Open an existing run folder.

        Args:
            path: path of the folder.
            writing: whether to hold it (to resume), so that no other process can write; reading
                needs no hold.
            needs_checkpoint: whether to refuse a run that has saved no state yet.

        Raises:
            InputError: the folder is missing, not a run folder, half-written, of another format, or
                in use.
        """
        path = Path(path)
        if not path.exists():
            raise InputError(f"the run folder {path} does not exist")
        if not path.is_dir():
            raise InputError(f"{path} is a file; a run folder, as training writes it, would do")
        lock = _take_lock(path) if writing and (path / "config.yaml").is_file() else None
        try:
            _require_run(path, needs_checkpoint)
        except BaseException:
            if lock is not None:
                lock.close()
            raise
        if lock is not None:
            sweep_temporaries(path)
        return cls(path, lock)

    @property
    def config(self) -> Path:
        """The file of the resolved configuration."""
        return self.path / "config.yaml"

    @property
    def checkpoints(self) -> Path:
        """The folder of checkpoints."""
        return self.path / "checkpoints"

    @property
    def metrics(self) -> Path:
        """The file of the metrics, one JSON object per line."""
        return self.path / "metrics.jsonl"

    def close(self) -> None:
        """Release the folder, so that other processes can write."""
        if self._lock is not None:
            self._lock.close()
            self._lock = None

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def _write_records(self, config_yaml: str, command: Sequence[str]) -> None:
        provenance, diff = collect_provenance(command)
        write_text(self.config, config_yaml)
        if diff:
            write_text(self.path / "provenance.diff", diff)
        # Last: its presence says that the folder is whole.
        write_json(self.path / "provenance.json", {"format": FORMAT, **provenance})


def policy_file(run: str | Path) -> Path:
    """Return the file of a run's best policy.

    Raises:
        InputError: the folder is missing, not a run folder, half-written, or of another version.
    """
    folder = RunFolder.open(run, needs_checkpoint=False)
    file = folder.path / POLICY_FILE
    if not file.is_file():
        raise InputError(
            f"the run folder {run} holds no policy.npz yet; resume it with"
            f" jaxleas train --resume {run}"
        )
    return file


def _take_lock(path: Path) -> FolderLock:
    return FolderLock(path, "the run folder", "name another --run-dir")


def _require_vacant(path: Path) -> None:
    if (path / "config.yaml").exists() and (path / "lock").exists():
        _take_lock(path).close()  # "in use" says more than "exists already"
    if {entry.name for entry in path.iterdir()} - {"lock"}:
        raise InputError(
            f"{path} exists already and is not empty; continue with --resume {path}, or name"
            " another --run-dir"
        )


def _require_run(path: Path, needs_checkpoint: bool) -> None:
    records = [(path / name).is_file() for name in ("config.yaml", "provenance.json")]
    if not any(records):
        raise InputError(f"{path} is not a run folder: it holds no config.yaml")
    if not all(records):
        raise InputError(
            f"the run folder {path} is half-written: its making was cut short; delete it and train "
            "again"
        )
    provenance = read_json(path / "provenance.json")
    found = provenance.get("format") if isinstance(provenance, dict) else None
    if found != FORMAT:
        version = provenance.get("jaxleas", "unknown") if isinstance(provenance, dict) else "?"
        raise InputError(
            f"the run folder {path} is in format {found}, written by jaxleas {version}; this "
            f"version reads format {FORMAT}: use that version of jaxleas, or train again"
        )
    if needs_checkpoint and not any((path / "checkpoints").glob("step_*.npz")):
        raise InputError(
            f"the run folder {path} is half-written: it has no checkpoint yet; continue with "
            f"jaxleas train --resume {path}"
        )
