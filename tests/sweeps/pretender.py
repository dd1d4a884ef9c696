"""A worker that trains nothing: it writes what a training would, slowly, and may be killed.

Each run folder gets a line in `diary` for every start and every end, so that tests can count. It
needs Python's own library alone, so that a start takes no time.
"""

import json
import os
import sys
import threading
import time
from pathlib import Path

EXAMINATIONS = 4
PAUSE = float(os.environ.get("PRETENDED_PAUSE", "0.05"))  # [s]


def pretend(run: Path, config: dict) -> None:
    run.mkdir(parents=True, exist_ok=True)
    note(run, "begun")
    rate = config["ppo"]["learning_rate"]
    rows = run / "metrics.jsonl"
    done = len(rows.read_text().splitlines()) if rows.is_file() else 0
    outcome = {"state": "done", "reason": "", "seconds": EXAMINATIONS * PAUSE, "values": {}}
    for examination in range(done + 1, EXAMINATIONS + 1):
        time.sleep(PAUSE)
        success = min(1.0, 100.0 * rate * examination / EXAMINATIONS)
        with rows.open("a") as stream:
            row = {"step": 640 * examination, "seconds": 1.0, "held_out/reached": success}
            stream.write(json.dumps(row) + "\n")
        if run.with_name(f"{run.name}.stop").is_file():
            outcome["state"] = "pruned"
            break
    if outcome["state"] == "done":
        outcome["values"] = {"held_out": min(1.0, 100.0 * rate), "steps_to_50%": 1.0 / rate}
    note(run, "ended")
    half = run.with_name(f".{run.name}.json")
    half.write_text(json.dumps(outcome))
    half.replace(run.with_name(f"{run.name}.json"))


def note(run: Path, word: str) -> None:
    with (run / "diary").open("a") as stream:
        stream.write(f"{word}\n")


def _die_with_parent() -> None:
    def wait_for_the_end() -> None:
        while os.read(0, 4096):
            pass
        os._exit(1)

    threading.Thread(target=wait_for_the_end, daemon=True).start()


if __name__ == "__main__":
    if "--lifeline" in sys.argv:
        _die_with_parent()
    for each in json.loads(Path(sys.argv[1]).read_text())["trainings"]:
        pretend(Path(each["run"]), json.loads(each["config"]))
