"""Transitions of crawls that the search found, as a policy would see and say them."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Bool, Float

from jaxleas.envs.gait_planning import (
    STANDING,
    GaitPlanning,
    action_of,
    in_contact,
)
from jaxleas.files import read_npz, write_npz
from jaxleas.gaits.crawl_search import search_crawls
from jaxleas.gaits.crawl_settings import CrawlSettings
from jaxleas.gaits.gait import Gait, taken
from jaxleas.gaits.wished_footholds import footing_of
from jaxleas.types import InputError

FIELDS, AT_ONCE = 24, 60
"""Fields of one part, and starts that are drawn on them."""
VERSION = 1


@dataclass(frozen=True, eq=False)
class Demonstrations:
    """Transitions, one a row.

    Attributes:
        observation: what a policy would see.
        numbers: numbers of the action, in [-1, 1].
        support: next support.
        placed: feet that the transition places anew; the numbers of others mean nothing.
    """

    observation: Float[np.ndarray, "N size"]
    numbers: Float[np.ndarray, "N 15"]
    support: np.ndarray
    placed: Bool[np.ndarray, "N 4"]

    def __len__(self) -> int:
        return len(self.support)


def collect(
    task: GaitPlanning,
    folder: Path,
    starts: int,
    seed: int,
    say: Callable[[int, int], None] = lambda done, rows: None,
) -> Demonstrations:
    """Return demonstrations from many starts; parts that lie in the folder are not searched again.

    Args:
        task: gait planning, whose contact code is five_way.
        folder: folder for the parts.
        starts: number of starts to search from.
        seed: seed of the first field.
        say: function that is told how many starts are done, and how many transitions there are.

    Raises:
        InputError: a part is of another configuration, or cannot be read.
    """
    if task.config.contact_code != "five_way":
        raise InputError("env.contact_code: the search names supports: set it to five_way")
    folder.mkdir(parents=True, exist_ok=True)
    wanted = task.config.model_dump_json()
    parts, done = [], 0
    for number in range(-(-starts // AT_ONCE)):
        path = folder / f"{number:05d}.npz"
        if path.exists():
            part = _read(path, wanted)
        else:
            part = _search(task, seed + FIELDS * number)
            write_npz(path, version=np.array(VERSION), config=np.array(wanted), **vars(part))
        parts.append(part)
        done = min(starts, done + AT_ONCE)
        say(done, sum(map(len, parts)))
    return _joined(parts)


def _search(task: GaitPlanning, first: int) -> Demonstrations:
    ground = task.make_world(range(first, first + FIELDS), False)
    drawn = task.draw_starts(ground, np.random.default_rng(first), AT_ONCE)
    starts = taken(drawn.state, np.flatnonzero(drawn.valid))
    gaits = search_crawls(task.config, footing_of(task.config, ground), starts, CrawlSettings())
    found = [_shown(task, ground, gait) for gait in gaits if gait.ending == "reached"]
    size = task.signature.size
    return _joined([_none(size), *found])


def _shown(task: GaitPlanning, ground: Any, gait: Gait) -> Demonstrations:
    """Return the transitions of one crawl."""
    before, after = (taken(gait.states, part) for part in (slice(None, -1), slice(1, None)))
    action = action_of(task.config, before, gait.commands, after.phase)
    support = np.asarray(gait.commands.support)
    seen = np.asarray(task.signature.pack(task.look(ground, before)))
    placed = ~(in_contact(before.phase.support) & STANDING[support])
    return Demonstrations(
        seen.astype(np.float32), action[:, :-1].astype(np.float32), support, placed
    )


def _read(path: Path, wanted: str) -> Demonstrations:
    names = tuple(Demonstrations.__dataclass_fields__)
    content = read_npz(path, ("version", "config", *names))
    if str(content["config"]) != wanted:
        raise InputError(
            f"{path}: these demonstrations are of another configuration (env): collect into another"
            " folder"
        )
    return Demonstrations(*(content[name] for name in names))


def _none(size: int) -> Demonstrations:
    return Demonstrations(
        np.zeros((0, size), np.float32),
        np.zeros((0, 15), np.float32),
        np.zeros(0, np.int64),
        np.zeros((0, 4), bool),
    )


def _joined(parts: list[Demonstrations]) -> Demonstrations:
    columns = zip(*(vars(part).values() for part in parts), strict=True)
    return Demonstrations(*map(np.concatenate, columns))
