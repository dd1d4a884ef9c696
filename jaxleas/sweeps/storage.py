"""The storage of a sweep's trials: a journal file, or any storage that Optuna reaches by URL."""

import logging
import warnings
from importlib import import_module
from pathlib import Path
from typing import Any

from jaxleas.types import InputError

SECONDS = 10.0  # time to wait for a storage proxy


def require_optuna() -> Any:
    """Return the module `optuna`, with its log silenced.

    Raises:
        InputError: Optuna is not installed.
    """
    try:
        optuna = import_module("optuna")
    except ImportError as error:
        raise InputError("sweeps need the extra: pip install 'jaxleas[sweep]'") from error
    optuna.logging.set_verbosity(logging.ERROR)
    warnings.filterwarnings("ignore", category=optuna.exceptions.ExperimentalWarning)
    return optuna


def open_storage(where: str | None, journal: Path) -> Any:
    """Return Optuna's storage.

    Args:
        where: location of the storage: grpc://HOST:PORT is a storage proxy, FILE.log a journal
            file elsewhere, any other URL a database; None: the default journal file.
        journal: default journal file.

    Raises:
        InputError: the storage cannot be reached, or its driver is not installed.
    """
    optuna = require_optuna()
    if where is None:
        mend_journal(journal)
        return _journal(optuna, journal)
    if where.startswith("grpc://"):
        return _proxy(optuna, where)
    if "://" not in where:
        if not where.endswith(".log"):
            raise InputError(
                f"--storage is {where!r}; give grpc://HOST:PORT, a database URL such as"
                " sqlite:///FILE.db, or a journal file FILE.log"
            )
        return _journal(optuna, Path(where))
    if where.startswith("sqlite") and where.partition("://")[2] in ("", "/", "/:memory:"):
        raise InputError(f"--storage {where} forgets all when it ends: give sqlite:///FILE.db")
    try:
        return optuna.storages.RDBStorage(where)
    except ImportError as error:
        raise InputError(f"--storage {where}: its driver is not installed: {error}") from error
    except Exception as error:  # SQLAlchemy and each driver have their own errors
        raise InputError(f"--storage {where} cannot be reached: {_first_line(error)}") from error


def mend_journal(path: Path) -> None:
    """Remove the leftovers of a killed writer: an incomplete last line, and its lock.

    Use this only for a journal that no other process is writing.
    """
    for leftover in path.parent.glob(f"{path.name}.lock*"):
        leftover.unlink(missing_ok=True)
    if not path.is_file():
        return
    content = path.read_bytes()
    whole = content[: content.rfind(b"\n") + 1]
    if whole != content:
        with path.open("r+b") as stream:
            stream.truncate(len(whole))


def _journal(optuna: Any, path: Path) -> Any:
    journal = optuna.storages.journal
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        return optuna.storages.JournalStorage(journal.JournalFileBackend(str(path)))
    except (OSError, ValueError) as error:
        raise InputError(f"the journal {path} cannot be used: {_first_line(error)}") from error


def _proxy(optuna: Any, where: str) -> Any:
    host, colon, port = where.removeprefix("grpc://").rpartition(":")
    if not (colon and host and port.isdecimal()):
        raise InputError(f"--storage is {where!r}; a storage proxy is grpc://HOST:PORT")
    try:
        proxy = optuna.storages.GrpcStorageProxy(host=host, port=int(port))
        proxy.wait_server_ready(timeout=SECONDS)
    except ImportError as error:
        raise InputError(f"--storage {where} needs grpcio: pip install 'jaxleas[sweep]'") from error
    except Exception as error:
        raise InputError(
            f"--storage {where} cannot be reached: no answer within {SECONDS:.0f} s"
        ) from error
    return proxy


def _first_line(error: BaseException) -> str:
    return (str(error) or type(error).__name__).splitlines()[0]
