"""Compile training in a fresh process, make one update, and print the times.

python -m benchmarks.workloads.first_update CONFIG.yaml
"""

import json
import sys
import time

begin = time.perf_counter()

import jax  # noqa: E402

from jaxleas.training import (  # noqa: E402
    Trainer,
    choose_devices,
    load_run_config,
    make_task,
    share_cores,
)
from jaxleas.xla import keep_compiled_programs  # noqa: E402


def main() -> None:
    """Print the times in seconds as a line of JSON."""
    jax.config.update("jax_persistent_cache_min_compile_time_secs", 0.0)
    keep_compiled_programs()
    imported = time.perf_counter()
    config = load_run_config(sys.argv[1])
    share_cores(config.ppo)
    trainer = Trainer(config, make_task(config), choose_devices("all", config.ppo))
    prepared = time.perf_counter()
    state = trainer.fresh_state()
    jax.block_until_ready(state)
    trainer.train_step.lower(trainer.world, state).compile()  # type: ignore[attr-defined]
    actor = state.normaliser, state.averaged
    trainer.examine.lower(trainer.held_out, *actor).compile()  # type: ignore[attr-defined]
    compiled = time.perf_counter()
    jax.block_until_ready(trainer.train_step(trainer.world, state))
    report = {
        "import": imported - begin,
        "terrain": prepared - imported,
        "compile": compiled - prepared,
        "done": time.time(),
    }
    print(json.dumps(report))


if __name__ == "__main__":
    main()
