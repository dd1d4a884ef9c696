"""Which condition ended a walk, where, and by how much."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import jax
import jax.numpy as jnp
import numpy as np

from jaxleas.conditions import MARGIN_LIMIT, TITLES
from jaxleas.types import GuidePath, InputError, RootMotion

if TYPE_CHECKING:
    from jaxleas.envs.steering import SteeringEnv
    from jaxleas.terrain import HeightMap

_EXACTLY = "exact "  # in files: beginning of the name of a condition that failed on polygons


@dataclass(frozen=True)
class Failure:
    """What is wrong with the last configuration of an invalid path.

    Attributes:
        condition: name of the condition that fails most, as a configuration gives it.
        margin: its signed margin [m], negative, at least -1; None for an exact condition, which
            answers yes or no.
        exactly: whether the condition fails on the terrain's polygons, where the map allowed it.
        else_exact: whether the exact conditions hold there, so that the height map alone refuses;
            None where they were not asked.
    """

    condition: str
    margin: float | None
    exactly: bool = False
    else_exact: bool | None = None

    def at(self, path: GuidePath) -> str:
        """Return what failed, where and by how much, as a clause.

        Args:
            path: invalid path, which ends where it fails.
        """
        where = ", on the terrain's polygons" if self.exactly else ""
        x, y, _ = path.position[-1]
        when = path.time[-1] - path.time[0]
        title = TITLES.get(self.condition, self.condition)
        clause = f"{title} fails at ({x:.2f}, {y:.2f}), {when:.1f} s{where}"
        if self.margin is not None:
            most = " or less" if self.margin <= -MARGIN_LIMIT else ""
            clause += f": margin {self.margin:.2g} m{most}"
        return clause + (" (the exact conditions hold there)" if self.else_exact else "")


def failures_to_arrays(failures: Sequence[Failure | None]) -> dict[str, np.ndarray]:
    """Return failures as arrays of a guide path file."""
    return {
        "failed": np.array(["" if each is None else _name_of(each) for each in failures], np.str_),
        "failed_margin": np.array(
            [np.nan if each is None or each.margin is None else each.margin for each in failures],
            np.float32,
        ),
    }


def failures_from_arrays(
    arrays: Mapping[str, np.ndarray], count: int, where: object
) -> tuple[Failure | None, ...]:
    """Return the failures among the arrays of a guide path file; none in files from before.

    Args:
        arrays: arrays of the file.
        count: number of its guide paths.
        where: name of the file, for messages.

    Raises:
        InputError: the arrays do not fit.
    """
    if "failed" not in arrays and "failed_margin" not in arrays:
        return ()
    names, margins = arrays.get("failed", np.zeros(0)), arrays.get("failed_margin", np.zeros(0))
    kinds = names.dtype.kind, margins.dtype.kind
    if names.shape != (count,) or margins.shape != (count,) or kinds != ("U", "f"):
        raise InputError(
            f"{where}: failed and failed_margin must be a text and a number for each of the"
            f" {count} paths"
        )
    return tuple(
        _failure(name, None if np.isnan(margin) else margin) if name else None
        for name, margin in zip(names.tolist(), margins.tolist(), strict=True)
    )


def _name_of(failure: Failure) -> str:
    """Return the name that a file gives to what failed."""
    return _EXACTLY * failure.exactly + failure.condition


def _failure(name: str, margin: float | None) -> Failure:
    return Failure(name.removeprefix(_EXACTLY), margin, exactly=name.startswith(_EXACTLY))


def failures_on_map(
    env: "SteeringEnv", terrain: "HeightMap", paths: Sequence[GuidePath], reasons: Sequence[str]
) -> list[Failure | None]:
    """Return which condition each invalid path violates most where it ends; None for the others.

    Args:
        env: steering task whose conditions judged.
        terrain: height map that was walked on.
        paths: guide paths.
        reasons: reason why each of them ended.
    """
    from jaxleas.terrain import make_atlas

    found: list[Failure | None] = [None] * len(paths)
    rows = [row for row, reason in enumerate(reasons) if reason == "invalid"]
    if not rows:
        return found
    ends = RootMotion(
        jnp.asarray(np.array([paths[row].position[-1] for row in rows]), jnp.float32),
        jnp.asarray(np.array([paths[row].velocity[-1] for row in rows]), jnp.float32),
        jnp.asarray(np.array([paths[row].yaw[-1] for row in rows]), jnp.float32),
    )
    atlas = make_atlas([terrain])

    @jax.jit
    def margins(motion: RootMotion) -> dict[str, jax.Array]:
        heights = env.local_heights(atlas, jnp.zeros(motion.yaw.shape, jnp.int32), motion)
        return {name: judge(heights, motion) for name, judge in env.conditions.items()}

    by_name = {name: np.asarray(each) for name, each in margins(ends).items()}
    for number, row in enumerate(rows):
        worst = min(by_name, key=lambda name, at=number: float(by_name[name][at]))
        found[row] = Failure(worst, float(by_name[worst][number]))
    return found
