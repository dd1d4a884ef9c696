"""The function behind `jaxleas export`."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from jaxleas.configuration import Allow
from jaxleas.files import policy_path
from jaxleas.types import InputError

if TYPE_CHECKING:
    from jaxleas.training import Policy, RunConfig

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
    """Export a policy as ONNX and StableHLO, compared with JAX first.

    Args:
        run: run folder, whose best policy is exported, policy.npz, or pretrained:NAME; with --page
            also an .onnx file, which is not exported again.
        out: folder for policy.onnx, policy.stablehlo and export.json; by default the run folder,
            and for a file a new folder of its name here.
        page: folder for a page on which the policy walks, static files for any web host.
        terrain: terrain of the page: height map, scene or mesh; docs/files.md lists all kinds.
        start: x, y [m] and heading [deg] on the page; by default a place with room around it.
        runtime: folder dist of the npm package onnxruntime-web; by default npm fetches it once.
        allow: your own code that the run's configuration names.
    """
    if page is None or terrain is None:
        if page is not None or terrain is not None or start is not None or runtime is not None:
            raise InputError("a page needs both --page DIR and --terrain FILE; nothing was written")
        _export(policy_path(run), out, allow)
        return
    from jaxleas.envs import DEFAULT_TASK, PAGES
    from jaxleas.terrain import import_terrain

    file = policy_path(run)
    task = DEFAULT_TASK if file.suffix == ".onnx" else _task_of(file, allow)
    if task not in PAGES:
        raise InputError(
            f"the task {task} has no page: --page is for {', '.join(PAGES)}; nothing was written"
        )
    ground = import_terrain(terrain)
    if file.suffix != ".onnx":
        file = _export(file, out, allow) / "policy.onnx"
    PAGES.find(task)(page, file, ground, start, runtime)
    print(f"{page}: serve it from anywhere, as with  python -m http.server --directory {page}")


def _task_of(path: Path, allow: Sequence[str]) -> str:
    from jaxleas.runs import policy_file
    from jaxleas.training import load_run_config, read_policy

    if path.suffix == ".npz":
        return read_policy(path, allow).config.task
    policy_file(path)
    return load_run_config(path / "config.yaml", allow=allow).env.task


def _export(path: Path, out: Path | None, allow: Sequence[str]) -> Path:
    """Export the policy of a run folder or of a file; return the folder of the artifacts."""
    import jax

    from jaxleas.export.recording import record_observations
    from jaxleas.export.write import export_policy
    from jaxleas.training import held_out_world, make_task

    is_single = path.suffix == ".npz"
    policy, config, text = _of_file(path, allow) if is_single else _of_run(path, allow)
    task = make_task(config, allow)
    observations = record_observations(
        policy, task, held_out_world(config, task), jax.random.key(RECORDING_KEY)
    )
    target = Path(out) if out is not None else Path(path.stem) if is_single else path
    success = None if is_single else success_of(path)
    record = export_policy(policy, target, observations, text, success)
    parity = record["parity"]
    print(
        f"{target}/policy.onnx and policy.stablehlo: within {parity['onnxruntime']:.1e} and"
        f" {parity['stablehlo']:.1e} of JAX on {parity['observations']} observations"
    )
    return target


def _of_run(folder: Path, allow: Sequence[str]) -> "tuple[Policy, RunConfig, str]":
    """Return the best policy of a run, and its configuration with its text."""
    from jaxleas.configuration import to_yaml
    from jaxleas.runs import policy_file
    from jaxleas.training import load_run_config, read_policy

    if folder.is_file():
        raise InputError(f"{folder} is no policy: a run folder or a policy.npz would do")
    policy = read_policy(policy_file(folder), allow)
    config = load_run_config(folder / "config.yaml", allow=allow)
    return policy, config, to_yaml(config)


def _of_file(file: Path, allow: Sequence[str]) -> "tuple[Policy, RunConfig, str]":
    """Return a policy that is a file, with a configuration whose terrain it can walk.

    The file does not state how the policy was trained: there is no text.
    """
    from jaxleas.configuration import merge
    from jaxleas.training import parse_run_config, read_policy

    policy = read_policy(file, allow)
    env = policy.config.model_dump(mode="json")
    sections = merge(policy.config.suited(env), {"env": env})
    return policy, parse_run_config(sections, str(file), allow), ""


def success_of(run: Path) -> list[dict[str, Any]] | None:
    """Return the cells of the run's results on the transitions suite, if it was evaluated."""
    from jaxleas.evaluation import evaluation_file
    from jaxleas.files import read_json

    file = evaluation_file(run, "transitions")
    if not file.is_file():
        return None
    results = read_json(file)
    return results.get("cells") if isinstance(results, dict) else None
