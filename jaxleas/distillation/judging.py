"""A round's verdict: the exact planner judges the policy on held-out terrain, cell by cell."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from jaxleas.distillation.config import JudgeConfig
from jaxleas.envs.steering import SteeringEnv
from jaxleas.evaluation import (
    Bookkeeping,
    CellResult,
    Planner,
    contender,
    judge_exact,
    make_suite,
    suited,
)
from jaxleas.files import read_json, require_version, typed, write_json
from jaxleas.guide import leas
from jaxleas.training import Policy
from jaxleas.types import InputError

VERSION = 1


@dataclass(frozen=True)
class Examiner:
    """An exact planner and the name that results give it."""

    name: str
    planner: Planner


def judge_round(
    file: Path,
    policy: Policy,
    method: str,
    examiner: Examiner,
    config: JudgeConfig,
    progress: Callable[[str], None],
) -> list[CellResult]:
    """Judge a policy, or read the results judged before.

    Args:
        file: file that keeps the results.
        policy: policy to be judged.
        method: name of the policy in the results.
        examiner: exact planner that judges.
        config: suites and number of starts.
        progress: callable that is given a description of what is being judged.
    """
    if file.is_file():
        return read_judged(file)
    env = SteeringEnv(policy.config.under_standard_conditions())
    cells: list[CellResult] = []
    for name in config.suites:
        suite = suited(make_suite(name, config.starts, held_out=True), env.robot)
        cells += judge_exact(
            env,
            {method: contender(env, leas(env, policy))},
            suite,
            {examiner.name: examiner.planner},
            bookkeeping=Bookkeeping(
                on_guides=lambda cell, *_: progress(f"{cell.name} at {cell.yaw:.0f} deg")
            ),
        )
    write_json(
        file,
        {
            "version": VERSION,
            "held_out": True,
            "suites": list(config.suites),
            "planner": examiner.name,
            "created": datetime.now(UTC).isoformat(timespec="seconds"),
            "cells": [cell.model_dump(mode="json") for cell in cells],
        },
    )
    return cells


def read_judged(file: Path) -> list[CellResult]:
    """Read a round's verdicts.

    Raises:
        InputError: the file is not one.
    """
    content = read_json(file)
    if not isinstance(content, dict) or not isinstance(content.get("cells"), list):
        raise InputError(f"{file} holds no verdicts of a round: it needs an object with cells")
    require_version(content, VERSION, file)
    return typed(list[CellResult], content["cells"], f"{file} holds no verdicts of a round")


def exact_success(cells: Sequence[CellResult]) -> float:
    """Return the mean share of starts that reached their goal with contacts all the way."""
    return sum(cell.planned or 0.0 for cell in cells) / len(cells)


def mean_robustness(cells: Sequence[CellResult]) -> float | None:
    """Return the robustness of the plans, mean over the cells [N]; None where there is none."""
    known = [cell.robustness for cell in cells if cell.robustness is not None]
    return sum(known) / len(known) if known else None


def summary(cells: Sequence[CellResult]) -> Mapping[str, float]:
    """Return each cell's exact success by its name, heading and, where it walks, speed."""

    def title(cell: CellResult) -> str:
        pace = f" {cell.speed:g} m/s" if cell.speed else ""
        return f"{cell.name} {cell.yaw:.0f}°{pace}"

    return {title(cell): cell.planned or 0.0 for cell in cells}
