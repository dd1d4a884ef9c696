"""Libraries read in a process of their own, which may crash, hang or take too much."""

import os
import textwrap

import numpy as np
import pytest

from jaxleas.terrain.foreign import asking
from jaxleas.terrain.foreign.asking import ask
from jaxleas.types import InputError

READER = """
import os, signal, time
import numpy as np
from jaxleas.terrain.foreign.answers import Answer, RefusedError

def load():
    pass

def read(path, options):
    match path.read_text():
        case "good":
            print("a library talks")
            return Answer({"heights": np.eye(2), "number": 3}, ["is said"])
        case "crash":
            os.kill(os.getpid(), signal.SIGSEGV)
        case "hungry":
            return Answer({"heights": np.ones(2**40)})
        case "busy":
            while True:
                pass
        case "asleep":
            time.sleep(1000)
        case "refused":
            raise RefusedError("has a flaw\\nof two lines")
        case "wrong":
            return {}["no such key"]
        case "lacking":
            import no_such_library
"""


@pytest.fixture
def reader(tmp_path, monkeypatch):
    """A reader named `trial`, in a server with small limits."""
    (tmp_path / "sitecustomize.py").write_text(
        textwrap.dedent(
            """
            import sys
            if "jaxleas.terrain.foreign.server" in " ".join(sys.orig_argv):
                import jaxleas.terrain.foreign as foreign
                from jaxleas.terrain.foreign import answers, limits
                foreign.__path__.append(PLACE)
                answers.READERS.add("trial")
                limits.CPU_SECONDS, limits.WALL_SECONDS = 1, 2
                import jaxleas.terrain.foreign.trial
            """
        ).replace("PLACE", repr(str(tmp_path)))
    )
    (tmp_path / "trial.py").write_text(READER)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    monkeypatch.setattr(asking, "_SERVER", asking._Server())
    yield lambda word: ask("trial", _written(tmp_path / "file.glb", word))
    asking._SERVER.close()


def _written(path, text):
    path.write_text(text)
    return path


def test_arrays_come_back_and_notes_are_said(reader, caplog):
    arrays = reader("good")
    np.testing.assert_array_equal(arrays["heights"], np.eye(2))
    assert int(arrays["number"]) == 3
    assert "file.glb is said" in caplog.text


@pytest.mark.parametrize(
    ("word", "problem"),
    [
        ("crash", "could not be read within 3 GiB"), ("busy", "could not be read within"),
        ("asleep", "could not be read within"),
        ("hungry", r"is damaged.*Memory|could not be read"),
        ("refused", r"file.glb has a flaw of two lines$"), ("wrong", r"is damaged.*KeyError"),
        ("lacking", r"library no_such_library, .* pip install 'jaxleas.maps.'"),
    ],
)  # fmt: skip
def test_whatever_happens_there_is_one_sentence_here(reader, word, problem):
    with pytest.raises(InputError, match=problem) as caught:
        reader(word)
    assert "\n" not in str(caught.value)
    assert reader("good")["heights"].shape == (2, 2)  # the next file is read


def test_a_server_that_was_killed_is_started_again(reader):
    reader("good")
    process = asking._SERVER._process
    assert process is not None
    process.kill()
    process.wait()
    assert reader("good")["heights"].shape == (2, 2)
    assert asking._SERVER._process is not process


def test_a_copy_of_this_process_has_a_server_of_its_own(reader):
    reader("good")
    pid = os.fork()
    if pid == 0:
        try:
            code = 0 if reader("good")["heights"].shape == (2, 2) else 1
        except BaseException:
            code = 2
        finally:
            asking._SERVER.close()
            os._exit(code)
    assert os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1]) == 0
    assert reader("good")["heights"].shape == (2, 2)
