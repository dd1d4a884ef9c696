"""python -m benchmarks.strangers [--inputs 100000] [--seed 0] [--only KIND] [--json FILE]

Sends so many mutated files through all readers. Each must be accepted, or refused by one sentence,
in bounded time and memory. Says what broke that, how to make the same input again, the slowest and
the hungriest. Ends with exit code 1 if anything broke. The result is written every 10,000 inputs,
and --resume continues from it.
"""

import argparse
import json
import os
import resource
import select
import subprocess
import sys
import time
from collections import Counter, defaultdict
from pathlib import Path
from typing import Any

from benchmarks.measurements import this_machine
from jaxleas.files import write_text

SILENCE = 90.0  # without a word a process is taken to hang [s]
A_PROCESS = 10_000  # inputs, then a fresh one: what readers keep (compiled programs) goes with it


def main() -> int:
    """Parse the command line, read, report."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.strangers")
    parser.add_argument("--inputs", type=int, default=100_000)
    parser.add_argument("--first", type=int, default=0, help="number of the first input")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--only", help="one kind of file")
    parser.add_argument("--json", type=Path, help="where to write the result")
    parser.add_argument("--resume", action="store_true", help="continue from the result in --json")
    given = parser.parse_args()
    if given.resume and not given.json:
        parser.error("--resume continues from a result: say --json")
    before = json.loads(given.json.read_text()) if given.resume else {}
    tally = Tally(before)
    begun = time.monotonic()
    first, last = given.first + before.get("inputs", 0), given.first + given.inputs
    while first < last:
        first = _one_process(first, min(first + A_PROCESS, last), given.seed, given.only, tally)
        if given.json:
            write_text(given.json, _text(tally, given, time.monotonic() - begun, before) + "\n")
    print(_text(tally, given, time.monotonic() - begun, before))
    return 1 if tally.failures else 0


def _text(tally: "Tally", given: argparse.Namespace, seconds: float, before: dict[str, Any]) -> str:
    spent = resource.getrusage(resource.RUSAGE_CHILDREN)
    report = tally.report() | {
        "command": f"python -m benchmarks.strangers --inputs {given.inputs} --seed {given.seed}",
        "seconds": round(seconds) + before.get("seconds", 0),
        "processor_seconds": round(spent.ru_utime + spent.ru_stime)
        + before.get("processor_seconds", 0),
        "machine": this_machine(),
    }
    return json.dumps(report, indent=2)


class Tally:
    """What became of the inputs, added to what a report of earlier ones says."""

    def __init__(self, before: dict[str, Any]) -> None:
        self.outcomes: dict[str, Counter[str]] = defaultdict(Counter)
        self.outcomes.update({k: Counter(each) for k, each in before.get("kinds", {}).items()})
        self.failures: dict[str, dict[str, Any]] = {
            f"{each['kind']}: {each['failure']}": each for each in before.get("failures", [])
        }
        self.slowest: dict[str, Any] = before.get("slowest", {"seconds": 0.0})
        self.hungriest: dict[str, Any] = before.get("hungriest", {"megabytes": 0.0})

    def add(self, line: dict[str, Any]) -> None:
        """Take one line of a process that reads."""
        self.outcomes[line["kind"]][line["outcome"]] += 1
        if line["failure"]:
            name = f"{line['kind']}: {line['failure']}"
            if name not in self.failures:
                print(f"input {line['number']}, {name}", flush=True)
            self.failures.setdefault(name, line | {"times": 0})["times"] += 1
        if line["seconds"] > self.slowest["seconds"]:
            self.slowest = line
        if line["megabytes"] > self.hungriest["megabytes"]:
            self.hungriest = line

    def report(self) -> dict[str, Any]:
        """Return all of it as plain values."""
        total = Counter[str]()
        for each in self.outcomes.values():
            total.update(each)
        return {
            "inputs": sum(total.values()),
            **{name: total[name] for name in ("accepted", "refused", "failed")},
            "slowest": self.slowest,
            "hungriest": self.hungriest,
            "kinds": {name: dict(self.outcomes[name]) for name in sorted(self.outcomes)},
            "failures": list(self.failures.values()),
        }


def _one_process(first: int, last: int, seed: int, only: str | None, tally: Tally) -> int:
    """Have a process read; return the number of the input that comes after all it has seen."""
    reading, writing = os.pipe()
    command = [
        sys.executable,
        "-m",
        "tests.robustness.hostile_files.trial",
        str(first),
        str(last),
        str(seed),
    ]
    process = subprocess.Popen(
        [*command, str(writing), *([only] if only else [])],
        pass_fds=[writing],
        env=os.environ | {"JAX_PLATFORMS": "cpu"},
    )
    os.close(writing)
    begun: dict[str, Any] | None = None
    pending, hung, spent = b"", False, 0.0
    with os.fdopen(reading, "rb", buffering=0) as stream:
        while True:
            ready, _, _ = select.select([stream], [], [], SILENCE)
            hung = not ready
            if hung and _is_held_up(process.pid, spent):
                hung = False
                continue
            spent = _cpu_seconds(process.pid)
            chunk = stream.read(65536) if ready else b""
            if not chunk:
                break
            *lines, pending = (pending + chunk).split(b"\n")
            for line in map(json.loads, lines):
                if "begins" in line:
                    begun = line
                else:
                    begun, first = None, line["number"] + 1
                    tally.add(line)
                    if first % 1000 == 0:
                        print(f"{first} inputs, {len(tally.failures)} kinds of failure", flush=True)
    if hung:
        process.kill()
    code = process.wait()
    if begun is None:
        if code != 0:
            raise RuntimeError(f"the reading process ended with {code} between two inputs")
        return first
    words = "hangs" if hung else f"ends the process with {code}"
    tally.add(
        {
            "number": begun["begins"],
            "kind": begun["kind"],
            "bytes": 0,
            "outcome": "failed",
            "failure": words,
            "seconds": SILENCE if hung else 0.0,
            "megabytes": 0.0,
        }
    )
    return begun["begins"] + 1


def _is_held_up(pid: int, spent: float) -> bool:
    """Tell whether a silent process was stopped or starved, rather than busy with one input."""
    state = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0]
    return state != "Z" and _cpu_seconds(pid) - spent < SILENCE / 2


def _cpu_seconds(pid: int) -> float:
    fields = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


if __name__ == "__main__":
    sys.exit(main())
