"""A sweep's folder.

sweep.yaml, sweep.json      the sweep, resolved; its name and owner
base.yaml                   the run configuration that trials start from, resolved
journal.log                 Optuna's journal of all trials, unless --storage names another
trials/0007/seed_0/         run folder of trial 7 with training seed 0
trials/0007/seed_0.json     its outcome; .job.json its job, .log the output of its worker
results.csv, results.json   the table
report.html                 pictures
lock                        held while a process conducts the sweep
"""

from dataclasses import asdict, dataclass
from pathlib import Path
from uuid import uuid4

from jaxleas.configuration import load_config, to_yaml
from jaxleas.files import FolderLock, read_typed, write_json, write_text
from jaxleas.sweeps.border import Sweep
from jaxleas.sweeps.config import SweepConfig
from jaxleas.training import load_run_config
from jaxleas.types import InputError

VERSION = 1
_BEGINNINGS = {"lock", "sweep.yaml", "base.yaml"}


@dataclass(frozen=True)
class _Record:
    name: str
    owner: str
    version: int = VERSION


@dataclass(frozen=True)
class SweepFolder:
    """A sweep's folder, held by one process.

    Attributes:
        path: absolute path of the folder.
        owner: identity that distinguishes this folder's trials from those of other machines in one
            storage.
    """

    path: Path
    owner: str
    _lock: FolderLock

    @property
    def journal(self) -> Path:
        """The file of Optuna's journal."""
        return self.path / "journal.log"

    def trial(self, number: int) -> Path:
        """Return the folder of one trial."""
        return self.path / "trials" / f"{number:04d}"

    def run(self, number: int, seed: int) -> Path:
        """Return the run folder of one training."""
        return self.trial(number) / f"seed_{seed}"

    def batch(self, number: int) -> Path:
        """Return the file of a job that trains several trials in one program."""
        return self.path / "batches" / f"{number:04d}.json"

    def close(self) -> None:
        """Release the folder, so that another process can conduct the sweep."""
        self._lock.close()


def open_folder(path: Path, sweep: Sweep) -> SweepFolder:
    """Make a sweep's folder, or open an existing one, and hold it.

    Raises:
        InputError: the folder belongs to something else or another sweep, or is held by another
            process.
    """
    path = Path(path).absolute()
    known = path / "sweep.json"
    if not known.is_file():
        require_vacant(path, _BEGINNINGS, "sweep")
    lock = hold(path)
    try:
        if not known.is_file():
            write_text(path / "sweep.yaml", to_yaml(sweep.config))
            write_text(path / "base.yaml", to_yaml(sweep.base))
            write_json(known, asdict(_Record(sweep.name, uuid4().hex)))
        record = read_typed(_Record, known, "record of a sweep", VERSION)
        _require_same(path, sweep)
        return SweepFolder(path, record.owner, lock)
    except BaseException:
        lock.close()
        raise


def _require_same(path: Path, sweep: Sweep) -> None:
    """Refuse another sweep; more trials and other workers are allowed."""
    then = load_config(SweepConfig, path / "sweep.yaml")
    free = {"trials": 1, "parallel": 1}
    if then.model_copy(update=free) != sweep.config.model_copy(update=free):
        raise InputError(
            f"{path} is a sweep with another file, {path / 'sweep.yaml'}: give that one, or"
            " another --out"
        )
    if load_run_config(path / "base.yaml", allow=sweep.allow) != sweep.base:
        raise InputError(
            f"{path} was begun with another run configuration, {path / 'base.yaml'}: restore"
            f" {sweep.config.config}, or give another --out"
        )


def require_vacant(path: Path, beginnings: set[str], kind: str) -> None:
    """Refuse a folder that holds more than the beginnings of what will be made there.

    Raises:
        InputError: the folder holds something else, or is a file.
    """
    if path.exists() and not path.is_dir():
        raise InputError(f"{path} is a file; --out names a folder")
    names = {entry.name for entry in path.iterdir()} if path.is_dir() else set()
    if {name for name in names if not name.startswith(".")} - beginnings:
        raise InputError(f"{path} exists and is no {kind}: give another --out")


def hold(path: Path) -> FolderLock:
    """Make a folder and hold it until the lock is closed.

    Raises:
        InputError: the folder cannot be made, or another process holds it.
    """
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"cannot make the folder {path}: {error.strerror}") from error
    return FolderLock(path, "the folder", "give another --out")
