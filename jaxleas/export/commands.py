"""The function behind `jaxleas export`."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from jaxleas.configuration import Allow
from jaxleas.types import InputError

RECORDING_KEY = 20_221_128  # seed of the recorded walks: always the same for the same policy


def export(
    run: Path,
    *,
    out: Path | None = None,
    page: Path | None = None,
    terrain: Path | None = None,
    start: tuple[float, float, float] | None = None,
    runtime: Path | None = None,
    allow: Allow = (),
) -> None:
    """Export the best policy of a run as ONNX and StableHLO, compared with JAX first.

    Args:
        run: run folder; with --page an .onnx file will do, too, which is not exported again.
        out: folder for policy.onnx, policy.stablehlo and export.json; by default the run folder.
        page: folder for a page on which the policy walks, static files for any web host.
        terrain: terrain of the page: height map, scene or mesh; docs/files.md lists all kinds.
        start: x, y [m] and heading [deg] on the page; by default a place with room around it.
        runtime: folder dist of the npm package onnxruntime-web; by default npm fetches it once.
        allow: your own code that the run's configuration names.
    """
    if page is None or terrain is None:
        if page is not None or terrain is not None or start is not None or runtime is not None:
            raise InputError("a page needs both --page DIR and --terrain FILE; nothing was written")
        _export_run(Path(run), out, allow)
        return
    from jaxleas.envs import DEFAULT_TASK, PAGES
    from jaxleas.terrain import import_terrain

    file = Path(run)
    task = DEFAULT_TASK if file.suffix == ".onnx" else _task_of(file, allow)
    if task not in PAGES:
        raise InputError(
            f"the task {task} has no page: --page is for {', '.join(PAGES)}; nothing was written"
        )
    ground = import_terrain(terrain)
    if file.suffix != ".onnx":
        file = _export_run(file, out, allow) / "policy.onnx"
    PAGES.find(task)(page, file, ground, start, runtime)
    print(f"{page}: serve it from anywhere, as with  python -m http.server --directory {page}")


def _task_of(folder: Path, allow: Sequence[str]) -> str:
    from jaxleas.runs import policy_file
    from jaxleas.training import load_run_config

    policy_file(folder)
    return load_run_config(folder / "config.yaml", allow=allow).env.task


def _export_run(folder: Path, out: Path | None, allow: Sequence[str]) -> Path:
    """Export a run; return the folder of the artifacts."""
    import jax

    from jaxleas.configuration import to_yaml
    from jaxleas.export.recording import record_observations
    from jaxleas.export.write import export_policy
    from jaxleas.runs import policy_file
    from jaxleas.training import held_out_world, load_run_config, make_task, read_policy

    if folder.is_file():
        raise InputError(f"{folder} is a file; the run folder, as train.py writes it, would do")
    policy = read_policy(policy_file(folder), allow)
    config = load_run_config(folder / "config.yaml", allow=allow)
    task = make_task(config, allow)
    observations = record_observations(
        policy, task, held_out_world(config, task), jax.random.key(RECORDING_KEY)
    )
    target = folder if out is None else Path(out)
    record = export_policy(policy, target, observations, to_yaml(config), success_of(folder))
    parity = record["parity"]
    print(
        f"{target}/policy.onnx and policy.stablehlo: within {parity['onnxruntime']:.1e} and"
        f" {parity['stablehlo']:.1e} of JAX on {parity['observations']} observations"
    )
    return target


def success_of(run: Path) -> list[dict[str, Any]] | None:
    """Return the cells of the run's results on the transitions suite, if it was evaluated."""
    from jaxleas.evaluation import evaluation_file
    from jaxleas.files import read_json

    file = evaluation_file(run, "transitions")
    if not file.is_file():
        return None
    results = read_json(file)
    return results.get("cells") if isinstance(results, dict) else None
