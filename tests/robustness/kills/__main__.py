"""python -m benchmarks.kills [--kills 200] [--seed 0] [--parallel 1] [--folder DIR] [--json FILE]

Trains something tiny once without interruption; then again and again, killing each training at
random moments and going on, until so many kills are done; compares every run that ends with the
first, bit by bit. Ends with exit code 1 if one differs, a process fails, or a folder is corrupt.
"""

import argparse
import json
import os
import random
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

# Before anything imports NumPy or JAX: no threads here, since they do not survive a fork.
os.environ |= {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1", "JAX_PLATFORMS": "cpu"}

from jaxleas.files import read_json, write_json


def main() -> int:
    """Parse the command line, kill, report."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.kills")
    parser.add_argument("--kills", type=int, default=200)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--parallel", type=int, default=1, help="so many runs at a time")
    parser.add_argument("--folder", type=Path, help="to work in; by default a temporary one")
    parser.add_argument("--json", type=Path, help="where to write the result, again and again")
    given = parser.parse_args()
    command = f"python -m benchmarks.kills --kills {given.kills} --seed {given.seed}"
    with tempfile.TemporaryDirectory() as temporary:
        folder = (given.folder or Path(temporary)).resolve()
        folder.mkdir(parents=True, exist_ok=True)
        begun = time.monotonic()
        if given.parallel > 1:
            reports = _side_by_side(given.kills, given.seed, given.parallel, folder)
            command += f" --parallel {given.parallel}"
        else:
            reports = _alone(given.kills, given.seed, folder)
        done: dict[str, Any] = {"failures": ["nothing was done"]}
        for report in reports:
            done = report | {"command": command, "seconds": round(time.monotonic() - begun)}
            if given.json:
                write_json(given.json, done)
        done["machine"] = this_machine()
        if given.json:
            write_json(given.json, done)
    print(json.dumps(done, indent=2))
    return 1 if done["failures"] else 0


def _alone(kills: int, seed: int, folder: Path) -> Iterator[dict[str, Any]]:
    """Kill; yield a report after every process."""
    os.environ["CI"] = "true"  # plain progress lines
    # Compiled once, by the run that is not killed, or by whoever shares their cache with us.
    _import_everything(os.environ.setdefault("JAX_COMPILATION_CACHE_DIR", str(folder / "xla")))
    from tests.robustness.kills.killing import Killer

    killer = Killer(folder, random.Random(seed))
    while (killer.kills < kills or killer.is_under_way) and not killer.failures:
        killer.one_process(kill=killer.kills < kills)
        print(f"{killer.kills} kills, {killer.resumes} resumes, {killer.equal} runs equal")
        yield killer.report()


def _side_by_side(kills: int, seed: int, count: int, folder: Path) -> Iterator[dict[str, Any]]:
    """Have several processes kill, each with its own runs and seed; yield the sum now and then."""
    shares = [kills // count + (index < kills % count) for index in range(count)]
    files = [folder / f"part_{index}.json" for index in range(count)]
    parts = []
    for index, (share, file) in enumerate(zip(shares, files, strict=True)):
        file.unlink(missing_ok=True)
        command = [sys.executable, "-m", "tests.robustness.kills", "--kills", str(share)]
        command += ["--seed", str(seed + index), "--folder", str(folder / f"part_{index}")]
        with (folder / f"part_{index}.log").open("w") as log:
            parts.append(subprocess.Popen([*command, "--json", str(file)], stdout=log, stderr=log))
    while any(part.poll() is None for part in parts):
        time.sleep(5.0)
        yield _sum([read_json(file) for file in files if file.is_file()])
    codes = [part.wait() for part in parts]
    total = _sum([read_json(file) for file in files if file.is_file()])
    if any(codes) and not total["failures"]:
        total["failures"] = [f"the processes ended with {codes}"]
    yield total


def _sum(reports: list[dict[str, Any]]) -> dict[str, Any]:
    """Return the sum of all that are numbers, and all failures."""
    total: dict[str, Any] = {"failures": []}
    for report in reports:
        for name, value in report.items():
            if isinstance(value, int):
                total[name] = total.get(name, 0) + value
            elif name == "failures":
                total[name] = total[name] + value
            elif isinstance(value, dict):
                total[name] = _sum([total.get(name, {}), value])
                total[name].pop("failures")
    return total


def this_machine() -> str:
    """Return what it was done on; asks JAX for devices, so only when nothing is forked any more."""
    from benchmarks import measurements

    return measurements.this_machine()


def _import_everything(cache: str) -> None:
    import jax
    import tensorboardX  # noqa: F401

    # Whoever imported it first may have been earlier than the variables.
    jax.config.update("jax_compilation_cache_dir", cache)
    jax.config.update("jax_persistent_cache_min_compile_time_secs", 0.0)

    import jaxleas.configuration.loading
    import jaxleas.training.loop  # noqa: F401


if __name__ == "__main__":
    sys.exit(main())
