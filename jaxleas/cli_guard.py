"""From an exception to one sentence and an exit code for a user at a terminal."""

import errno
import os
import sys
from collections.abc import Callable
from pathlib import Path

from jaxleas.runs import interrupts_kept

FAILED = 1
BAD_INPUT = 2
INTERRUPTED = 130
# A full disk, a name that no file can have, files without permission to read or write.
_NOT_OUR_DOING = (*(errno.ENOSPC, errno.EDQUOT, errno.ENAMETOOLONG), *(errno.EACCES, errno.EROFS))


class UsageError(Exception):
    """A wrong command line; raised where importing JAX for a sentence would be too slow."""


def run_guarded(main: Callable[[], None]) -> int:
    """Run `main` and return the exit code of the process.

    A `JaxleasError`, a wrong command line, a full disk and files without permission become one
    sentence on standard error and exit code 2 (or the error's own `exit_code`); Ctrl-C is quiet
    and gives 130, even where Python discards it at first; anything else is a bug and keeps its
    traceback. With `--traceback` on the command line, or JAXLEAS_TRACEBACK set, every error keeps
    it.

    Args:
        main: function to run; it reads `sys.argv` only when called, after `--traceback` is removed.
    """
    wants_traceback = bool(os.environ.get("JAXLEAS_TRACEBACK"))
    if "--traceback" in sys.argv:
        sys.argv.remove("--traceback")
        wants_traceback = True
    try:
        with interrupts_kept():
            main()
        sys.stdout.flush()
    except KeyboardInterrupt:
        return INTERRUPTED
    except BrokenPipeError:  # as in `jaxleas ... | head`: the reader has closed the pipe
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return FAILED
    except Exception as error:
        if wants_traceback or not _is_for_people(error):
            raise
        sentence = " ".join(str(error).split())
        print(f"{Path(sys.argv[0]).name}: {sentence}", file=sys.stderr)
        return getattr(error, "exit_code", BAD_INPUT)
    return 0


def _is_for_people(error: Exception) -> bool:
    if isinstance(error, UsageError):
        return True
    from jaxleas.types import JaxleasError

    not_our_doing = isinstance(error, OSError) and error.errno in _NOT_OUR_DOING
    return not_our_doing or isinstance(error, JaxleasError)
