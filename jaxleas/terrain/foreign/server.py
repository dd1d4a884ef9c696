"""python -m jaxleas.terrain.foreign.server: reads files, each in a fresh copy of this process.

A request is a line of JSON on standard input: `reader` (a module of this folder), `path`, `options`
and `answer` (where to write). Its reply is a line with `code`: the exit code of the process that
read, or minus the number of the signal that ended it. The process ends with its input.
"""

import json
import os
import sys
import tempfile
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from jaxleas.terrain.foreign.answers import LACKS, READERS, REFUSED, Answer, RefusedError
from jaxleas.terrain.foreign.limits import limit_this_process


def serve() -> None:
    """Answer requests until the input ends."""
    replies = os.fdopen(os.dup(1), "w", buffering=1)
    os.dup2(2, 1)  # what libraries print is no reply
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)  # where libraries may leave logs
        for line in sys.stdin:
            request = json.loads(line)
            _load(request["reader"])
            print(json.dumps({"code": _in_a_copy(request)}), file=replies)


def _load(reader: str) -> None:
    """Load a library here once, not in each copy; a copy says what is missing."""
    if reader in READERS:
        try:
            import_module(f"jaxleas.terrain.foreign.{reader}").load()
        except ImportError:
            return


def _in_a_copy(request: dict[str, Any]) -> int:
    pid = os.fork()
    if pid == 0:
        code = 1
        try:
            code = _read(request)
        except MemoryError:
            code = 1
        finally:
            os._exit(code)
    return os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1])


def _read(request: dict[str, Any]) -> int:
    if request["reader"] not in READERS:
        return 1
    limit_this_process()
    target = Path(request["answer"])
    try:
        module = import_module(f"jaxleas.terrain.foreign.{request['reader']}")
        answer: Answer = module.read(Path(request["path"]), request["options"])
        with target.open("wb") as stream:
            np.savez(stream, allow_pickle=False, **answer.as_arrays())
        return 0
    except RefusedError as error:
        target.write_text(_one_line(str(error)))
        return REFUSED
    except ImportError as error:
        target.write_text(_one_line(error.name or str(error)))
        return LACKS
    except Exception as error:
        words = _one_line(f"{type(error).__name__}: {error}")[:160]
        target.write_text(f"is damaged, or of a kind that is not read ({words})")
        return REFUSED


def _one_line(text: str) -> str:
    return " ".join(ascii(text)[1:-1].replace("\\n", " ").split())[:400]


if __name__ == "__main__":
    serve()
