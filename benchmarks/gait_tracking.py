"""Gait plans followed in physics: `python -m benchmarks.gait_tracking`.

Plans of the search on fields that nothing was tuned on are followed by the phase tracker, all of
one kind in one world. An episode lasts 90 s at most, and succeeds if the robot then stands within
0.5 m of the goal, without having fallen. --episodes N draws N for each kind, of those starts to
which the search finds a plan. Replaces the tracker's rows in benchmarks/results/gaits.json; with
--held-out it prints only, from fields for tuning.
"""

import argparse
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from benchmarks.contacts.rows import Row
from benchmarks.field_worlds import place_of, world_of
from benchmarks.gaits import OUT
from benchmarks.measurements import others, this_machine, write_measurements
from jaxleas.cli_guard import run_guarded
from jaxleas.controllers import PhaseTracker, TrackerSettings, Walk, joined, standing_with
from jaxleas.crossing import Tracking, track
from jaxleas.envs.gait_planning import GaitPlanning, GaitPlanningConfig, GaitWorldsConfig, Shares
from jaxleas.gaits import (
    GaitPlan,
    eased,
    footing_of,
    plan_of,
    quickened,
    search_crawls,
    taken,
    track_of,
)
from jaxleas.physics import DEFAULT_BODY, load_body, make_physics
from jaxleas.terrain import EVALUATION_SEED, FIELD_KINDS, TUNING_SEED, HeightMap
from jaxleas.types import is_ground

SUCCESS = {"flat": 99.5, "gaps": 97.0, "stones": 97.0, "stairs": 92.0}
"""This project's targets [%], by kind of field; FTS likewise."""
FTS = {"flat": 0.985, "gaps": 0.967, "stones": 0.970, "stairs": 0.751}
FTER = {"flat": 0.016, "gaps": 0.023, "stones": 0.021, "stairs": 0.049}
"""Those of Tsounis et al. 2020, table III [m]."""
FIELDS, SECONDS, NEAR = 20, 90.0, 0.5
INSIDE = 0.45
"""Distance from the goal at which plans end: a robot that is 1 cm off is still near [m]."""
Planned = tuple[dict[int, HeightMap], list[tuple[int, GaitPlan]]]
"""Fields by number, and plans, each with the number of its field."""


def main(arguments: Sequence[str]) -> None:
    """Track the plans and write the rows."""
    given = _parser().parse_args(arguments)
    machine = this_machine()
    for kind in given.kinds:
        planned, begin = _plans(given, kind), time.perf_counter()
        made = _tracked(given, *planned)
        seconds = time.perf_counter() - begin
        print(f"{kind}: {len(made)} episodes in {seconds:.0f} s", file=sys.stderr, flush=True)
        measured = [row.measurement(machine) for row in _rows(kind, made, planned[1])]
        for each in measured:
            print(f"{each.name}: {each.value} {each.unit}", flush=True)
        if not given.held_out:  # kind by kind, so that what is done is kept
            write_measurements(OUT, [*others(OUT, measured), *measured])


def _rows(
    kind: str, made: Sequence[Tracking], plans: Sequence[tuple[int, GaitPlan]]
) -> Iterator[Row]:
    succeeded = []
    for each, (number, plan) in zip(made, plans, strict=True):
        off = each.com[:2] - plan.goal - place_of(number)[:2]
        stands = each.outcome in ("followed", "astray", "time")
        succeeded.append(stands and bool(np.hypot(*off) <= NEAR))
        print(
            f"{kind}: {each.outcome} {each.cause} after {each.time:.1f} s in support"
            f" {each.support} of {plan.length}; FTS {each.fts:.3f}, FTER {each.fter:.4f} m",
            file=sys.stderr,
        )
    share = 100.0 * float(np.mean(succeeded))
    fts, fter = np.mean([each.fts for each in made]), np.nanmean([each.fter for each in made])
    for name in ("tracker", "controller"):  # the tracker is the best controller so far
        yield Row(f"{name}_{kind}_success", "%", [share], None, SUCCESS.get(kind), "higher")
        yield Row(f"{name}_{kind}_fts", "1", [float(fts)], None, FTS.get(kind), "higher")
        yield Row(f"{name}_{kind}_fter", "m", [float(fter)], FTER.get(kind), None, "lower")


def _plans(given: argparse.Namespace, kind: str) -> Planned:
    """Return fields by number, and plans to goals 2 to 5 m away, with the field of each."""
    config = GaitPlanningConfig(goal_radius=INSIDE)
    shares = {name: float(name == kind) for name in FIELD_KINDS}
    task = GaitPlanning(config, GaitWorldsConfig(shares=Shares(**shares)))
    first = (TUNING_SEED if given.held_out else EVALUATION_SEED) + FIELDS * FIELD_KINDS.index(kind)
    first += given.shift
    ground = task.make_world(range(first, first + FIELDS), True)
    drawn = task.draw_starts(ground, np.random.default_rng(first), 8 * given.episodes, True)
    starts = taken(drawn.state, np.flatnonzero(drawn.valid)[: given.episodes + given.spare])
    gaits = search_crawls(config, footing_of(config, ground), starts)
    ways = list(zip(starts.field.tolist(), gaits, strict=True))
    reached = [(number, gait) for number, gait in ways if gait.ending == "reached"]
    print(f"{kind}: {len(reached)} of {len(ways)} planned", file=sys.stderr, flush=True)
    plans = [(number, plan_of(config, gait, "search")) for number, gait in reached]
    plans = [each for each in plans if each[1].length][: given.episodes]
    fields = {
        number: HeightMap(
            np.where(is_ground(ground.heights[number]), ground.heights[number], np.nan),
            ground.resolution,
            (0.5 * ground.resolution, 0.5 * ground.resolution),
        )
        for number in sorted({number for number, _ in plans})
    }
    return fields, plans


def _tracked(
    given: argparse.Namespace,
    fields: dict[int, HeightMap],
    plans: list[tuple[int, GaitPlan]],
) -> list[Tracking]:
    """Follow plans on fields that lie side by side."""
    body, settings = load_body(DEFAULT_BODY), TrackerSettings()
    tracks = []
    for number, plan in plans:
        place = place_of(number)

        def heights(points: np.ndarray, number: int = number, place: np.ndarray = place):
            return fields[number].height_at(points - place[:2])

        phases = replace(
            plan.phases,
            com=plan.phases.com + place.astype(np.float32),
            feet=plan.phases.feet + place.astype(np.float32),
        )
        moved = quickened(eased(replace(plan, phases=phases)), given.speed)
        tracks.append(track_of(moved, heights, (body.foot_radius, settings.clearance)))
    together = joined(tracks)
    coms = together.at(np.zeros(len(together))).com
    start, _ = standing_with(body, coms, together.yaws[:, 0], together.feet[:, 0])
    physics = make_physics(body, len(together), world_of(fields))
    return track(Walk(physics, PhaseTracker(body, together, settings)), start, SECONDS)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.gait_tracking", description=__doc__)
    parser.add_argument("--episodes", type=int, default=20)
    parser.add_argument("--spare", type=int, default=5)
    parser.add_argument("--kinds", nargs="+", choices=FIELD_KINDS, default=list(SUCCESS))
    parser.add_argument("--speed", type=float, default=2.5)
    parser.add_argument("--shift", type=int, default=0)
    parser.add_argument("--held-out", action="store_true")
    return parser


if __name__ == "__main__":
    sys.exit(run_guarded(lambda: main(sys.argv[1:])))
