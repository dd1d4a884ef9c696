"""The function behind `jaxleas fit`."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from jaxleas.configuration import Allow
from jaxleas.surrogates.settings import FitSettings
from jaxleas.types import InputError

USUAL = FitSettings()


def fit(
    labels: Sequence[Path],
    *,
    out: Path,
    planner: str | None = None,
    policy: Path | None = None,
    where: Sequence[Path] = (),
    epochs: int = USUAL.epochs,
    code: int = USUAL.code,
    hidden: int = USUAL.hidden,
    seed: int = USUAL.seed,
    allow: Allow = (),
) -> None:
    """Fit a surrogate, a contact planner's learned stand-in, to its verdicts.

    Args:
        labels: folders that `jaxleas label` wrote.
        out: file of the surrogate, .npz.
        planner: planner whose verdicts are accepted; any planner by default.
        policy: run folder or policy whose environment the surrogate is for; by default the
            environment's defaults for the robot that was judged.
        where: additional folders with guide paths and scenes.
        epochs: passes over the guide paths.
        code: number of outputs of the network's encoder.
        hidden: number of values that the network carries along.
        seed: random seed of the fit.
        allow: conditions of your own under which the policy was trained.
    """
    from pydantic import ValidationError

    from jaxleas.envs.steering import SteeringConfig, SteeringEnv
    from jaxleas.guide import load_policy
    from jaxleas.robots import robot_digest
    from jaxleas.surrogates.fit import fit as fit_surrogate
    from jaxleas.surrogates.label_files import read_labels
    from jaxleas.surrogates.surrogate import Identity
    from jaxleas.surrogates.surrogate_file import write_surrogate
    from jaxleas.terrain import DEFAULT_RESOLUTION

    try:
        settings = FitSettings(epochs=epochs, code=code, hidden=hidden, seed=seed)
    except ValidationError as error:
        first = error.errors()[0]
        raise InputError(f"--{first['loc'][0]} {first['input']}: {first['msg'].lower()}") from error
    config = None if policy is None else load_policy(policy, allow).config
    found = read_labels(list(labels), list(where), DEFAULT_RESOLUTION)
    if config is None:
        try:
            config = SteeringConfig.for_robot(found.robot)
        except InputError as error:
            raise InputError(f"{labels[0]} holds verdicts on {found.robot}: {error}") from error
    env = SteeringEnv(config, allow=allow)
    if planner is not None and found.planner != planner:
        raise InputError(
            f"{labels[0]} holds verdicts of the {found.planner} planner, not of {planner}"
        )
    if found.robot != config.robot:
        raise InputError(
            f"{labels[0]} holds verdicts on {found.robot}, but the policy is for {config.robot}:"
            f" label guide paths with --robot {config.robot}"
        )
    if found.robot_digest not in (None, robot_digest(config.robot)):
        raise InputError(
            f"{labels[0]} holds verdicts on {config.robot} as it was before its file changed: label"
            " the guide paths again"
        )
    identity = Identity.of(found.planner, found.parameters, config)

    def progress(epoch: int, loss: float) -> None:
        print(f"epoch {epoch} of {epochs}: {loss:.5f} nats on the terrain held out", flush=True)

    surrogate = fit_surrogate(found.paths, found.atlas, env, identity, settings, progress)
    write_surrogate(out, surrogate)
    print(describe(surrogate.report))
    if found.passed_over:
        print(f"{found.passed_over} guide paths had no verdict within the planner's time limit")
    print(f"{out}: stands in for the {found.planner} planner")


def describe(report: dict[str, Any]) -> str:
    """Return a surrogate's report as a few lines of text."""
    guides, terrains = report["guides"], report["terrains"]
    lines = [
        f"learned from {guides['learned']} guide paths on {terrains['learned']} terrains,"
        f" calibrated on {guides['calibration']} on {terrains['calibration']}; judged on"
        f" {report['guide']['count']} on {terrains['judged']} others:"
    ]
    for name in ("stretch", "guide"):
        part = report[name]
        lines.append(
            f"  by {name}: {part['failed']} of {part['count']} failed; balanced accuracy"
            f" {100 * part['balanced_accuracy']:.1f} %, area under the curve"
            f" {part['area_under_curve']:.3f}, calibration error"
            f" {100 * part['calibration_error']:.2f} %"
        )
    return "\n".join(lines)
