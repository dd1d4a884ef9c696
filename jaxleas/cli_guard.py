"""From an exception to what a person at a terminal wants: one sentence and an exit code."""

import errno
import os
import sys
from collections.abc import Callable
from pathlib import Path

from jaxleas.runs.swallowed import interrupts_kept

FAILED = 1
BAD_INPUT = 2
INTERRUPTED = 130
# A full disk, a name that no file can have, files that are not ours to read or write.
_NOT_OUR_DOING = (*(errno.ENOSPC, errno.EDQUOT, errno.ENAMETOOLONG), *(errno.EACCES, errno.EROFS))


class UsageError(Exception):
    """The command line itself is wrong; raised where importing JAX for a sentence is too slow."""


def run_guarded(main: Callable[[], None]) -> int:
    """Run `main` and return the exit code of the process.

    A `JaxleasError`, a wrong command line, a full disk and files that are not ours to touch become
    one sentence on standard error and exit code 2 (or the error's own `exit_code`); Ctrl-C is quiet
    and gives 130, also where Python throws it away at first; anything else is a bug of ours and
    keeps its traceback. With `--traceback` on the command line, or JAXLEAS_TRACEBACK set, every
    error keeps it.

    Args:
        main: what to run; reads `sys.argv` only when called, since `--traceback` is taken out.
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
    except BrokenPipeError:  # as in `jaxleas ... | head`: nobody listens any more
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
    from jaxleas.types.errors import JaxleasError

    not_our_doing = isinstance(error, OSError) and error.errno in _NOT_OUR_DOING
    return not_our_doing or isinstance(error, JaxleasError)
