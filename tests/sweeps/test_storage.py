"""Trials are remembered wherever Optuna can reach; a storage that cannot be is one sentence."""

import socket
import threading

import pytest

from jaxleas.sweeps import storage as storages
from jaxleas.sweeps.border import open_sweep
from jaxleas.sweeps.folder import open_folder
from jaxleas.sweeps.study import Study
from jaxleas.sweeps.sweep import run_sweep
from jaxleas.types import InputError
from tests.sweeps.files import write_sweep
from tests.sweeps.pretended import PRETENDER, conduct

optuna = pytest.importorskip("optuna", reason="the extra sweep is not installed")


def free_port() -> int:
    with socket.socket() as server:
        server.bind(("localhost", 0))
        return server.getsockname()[1]


@pytest.fixture
def proxy(tmp_path):
    pytest.importorskip("grpc")
    behind = optuna.storages.RDBStorage(f"sqlite:///{tmp_path}/behind.db")
    port = free_port()
    serve = optuna.storages.run_grpc_proxy_server
    options = {"host": "localhost", "port": port}
    threading.Thread(target=serve, args=(behind,), kwargs=options, daemon=True).start()
    return f"grpc://localhost:{port}", behind


def test_a_sweep_through_a_storage_proxy(tmp_path, proxy):
    url, behind = proxy
    path = write_sweep(tmp_path, trials=2)
    assert [each.state for each in conduct(path, tmp_path / "out", PRETENDER, url)] == ["done"] * 2
    (study,) = optuna.get_all_study_summaries(behind)
    assert (study.study_name, study.n_trials) == ("sweep", 2)


def test_a_study_of_another_sweep_is_refused(tmp_path):
    url = f"sqlite:///{tmp_path}/study.db"
    for name, seed in (("one", 0), ("two", 1)):
        (tmp_path / name).mkdir()
        sweep = open_sweep(write_sweep(tmp_path / name, seed=seed))
        folder = open_folder(tmp_path / name / "out", sweep)
        try:
            if name == "one":
                Study(sweep, folder, url)
                continue
            with pytest.raises(InputError, match="holds another sweep called sweep"):
                Study(sweep, folder, url)
        finally:
            folder.close()


@pytest.mark.parametrize(
    ("storage", "said"),
    [
        ("somewhere", "give grpc://HOST:PORT, a database URL"),
        ("grpc://localhost", "a storage proxy is grpc://HOST:PORT"),
        ("grpc://localhost:{port}", "no answer within"),
        ("sqlite:////nowhere/at/all.db", "cannot be reached"),
        ("sqlite://", "forgets all when it ends"),
        ("oracel://host/db", "--storage oracel://host/db"),
        ("/nowhere/at/all.log", "/nowhere/at/all.log"),
    ],
)
def test_a_storage_that_cannot_be_reached_is_one_sentence(tmp_path, storage, said, monkeypatch):
    monkeypatch.setattr(storages, "SECONDS", 0.5)
    if storage.startswith("/"):
        (tmp_path / "file").write_text("")
        storage = str(tmp_path / "file" / "all.log")
        said = "all.log"
    with pytest.raises(InputError, match=said) as refusal:
        storages.open_storage(storage.format(port=free_port()), tmp_path / "journal.log")
    assert "\n" not in str(refusal.value)


def test_a_sweep_that_cannot_begin_leaves_nothing_behind(tmp_path):
    with pytest.raises(InputError, match="a database URL"):
        run_sweep(write_sweep(tmp_path), tmp_path / "out", storage="somewhere")
    assert not (tmp_path / "out").exists()


def test_without_optuna_one_sentence_says_which_extra(monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "optuna", None)
    with pytest.raises(InputError, match=r"pip install 'jaxleas\[sweep\]'"):
        storages.require_optuna()


def test_a_journal_that_was_cut_short_is_mended(tmp_path):
    journal = tmp_path / "journal.log"
    journal.write_bytes(b'{"op_code": 0}\n{"op_co')
    (tmp_path / "journal.log.lock").symlink_to("journal.log")
    storages.mend_journal(journal)
    assert journal.read_bytes() == b'{"op_code": 0}\n'
    assert not (tmp_path / "journal.log.lock").is_symlink()
