"""python -m benchmarks.kills [--kills 200] [--seed 0] [--folder DIR] [--json FILE]

Trains something tiny once without interruption; then again and again, killing each training at
random moments and going on, until so many kills are done; compares every run that ends with the
first, bit by bit. Ends with exit code 1 if one differs, a process fails, or a folder is corrupt.
"""

import argparse
import json
import os
import random
import sys
import tempfile
import time
from pathlib import Path

# Before anything imports NumPy or JAX: no threads here, since they do not survive a fork.
os.environ |= {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1", "JAX_PLATFORMS": "cpu"}


def main() -> int:
    """Parse the command line, kill, report."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.kills")
    parser.add_argument("--kills", type=int, default=200)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--folder", type=Path, help="to work in; by default a temporary one")
    parser.add_argument("--json", type=Path, help="where to write the result")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        folder = given.folder or Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        # Compiled once, by the run that is not killed.
        os.environ["JAX_COMPILATION_CACHE_DIR"] = str((folder / "xla").resolve())
        os.environ["JAX_PERSISTENT_CACHE_MIN_COMPILE_TIME_SECS"] = "0"
        os.environ["CI"] = "true"  # plain progress lines
        _import_everything()
        from benchmarks.kills.killing import Killer

        killer = Killer(folder, random.Random(given.seed))
        begun = time.monotonic()
        while killer.kills < given.kills and not killer.failures:
            killer.one_process(kill=True)
            _tell(killer)
        while killer.is_under_way and not killer.failures:
            killer.one_process(kill=False)
        print()
        report = killer.report() | {
            "command": f"python -m benchmarks.kills --kills {given.kills} --seed {given.seed}",
            "seconds": round(time.monotonic() - begun),
        }
    text = json.dumps(report, indent=2)
    print(text)
    if given.json:
        given.json.write_text(text + "\n")
    return 1 if killer.failures else 0


def _tell(killer: "object") -> None:
    line = f"{killer.kills} kills, {killer.resumes} resumes, {killer.equal} runs equal"  # type: ignore[attr-defined]
    print(line, end="\r" if sys.stdout.isatty() else "\n", flush=True)


def _import_everything() -> None:
    import tensorboardX  # noqa: F401

    import jaxleas.training.configuration
    import jaxleas.training.loop  # noqa: F401


if __name__ == "__main__":
    sys.exit(main())
