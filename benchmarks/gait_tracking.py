"""Gait plans followed in physics: `python -m benchmarks.gait_tracking`.

Plans of the search on fields that nothing was tuned on are followed by the phase tracker, all of
one kind in one world. An episode lasts 90 s at most, and succeeds if the robot then stands within
0.5 m of the goal, without having fallen. --episodes N draws N for each kind, of those starts to
which the search finds a plan. --robot heavy, long or short has robots follow them that differ from
what the tracker assumes (table III of DeepGait). Replaces the tracker's rows in
benchmarks/results/gaits.json; with --held-out it prints only, from fields for tuning.
"""

import argparse
import itertools
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from benchmarks.contacts.rows import Row
from benchmarks.field_worlds import place_of, world_of
from benchmarks.gait_starts import starts_on
from benchmarks.gaits import OUT
from benchmarks.measurements import others, this_machine, write_measurements
from benchmarks.varied_robots import VARIED, Varied, varied_robot
from jaxleas.cli_guard import run_guarded
from jaxleas.controllers import (
    TICK,
    PhaseTracker,
    Ticked,
    TrackerSettings,
    Walk,
    joined,
    standing_with,
)
from jaxleas.crossing import Tracking, track
from jaxleas.envs.gait_planning import GaitPlanningConfig
from jaxleas.gaits import (
    GaitPlan,
    eased,
    footing_of,
    plan_of,
    quickened,
    search_crawls,
    track_of,
)
from jaxleas.physics import DEFAULT_BODY, load_body, make_physics
from jaxleas.runs import Progress
from jaxleas.terrain import FIELD_KINDS, HeightMap
from jaxleas.types import is_ground

SUCCESS = {"flat": 99.5, "gaps": 97.0, "stones": 97.0, "stairs": 92.0}
"""This project's targets [%], by kind of field."""
PUBLISHED: dict[str, dict[str, tuple[float, float, float]]] = {
    "nominal": {
        "flat": (99.8, 0.985, 0.016),
        "gaps": (96.4, 0.967, 0.023),
        "stones": (96.8, 0.970, 0.021),
        "stairs": (90.6, 0.751, 0.049),
    },
    "heavy": {
        "flat": (99.4, 0.916, 0.028),
        "gaps": (94.6, 0.906, 7.332),
        "stones": (98.4, 0.895, 0.032),
        "stairs": (82.4, 0.605, 0.060),
    },
    "long": {
        "flat": (99.0, 0.968, 0.020),
        "gaps": (95.2, 0.952, 0.025),
        "stones": (97.6, 0.975, 0.020),
        "stairs": (76.4, 0.618, 0.069),
    },
    "short": {
        "flat": (100.0, 0.990, 0.017),
        "gaps": (97.8, 0.965, 0.022),
        "stones": (97.4, 0.971, 0.021),
        "stairs": (89.6, 0.541, 0.058),
    },
}
"""Success [%], FTS and FTER [m] of Tsounis et al. 2020, table III; all but FTER are this project's
targets, too, where no other stands above."""
SECONDS, NEAR = 90.0, 0.5
INSIDE, SHOWN = 0.45, 50
"""Distance from the goal at which plans end: a robot that is 1 cm off is still near [m]; ticks
between two updates of the progress."""
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
        measured = [row.measurement(machine) for row in _rows(kind, given.robot, made, planned[1])]
        for each in measured:
            print(f"{each.name}: {each.value} {each.unit}", flush=True)
        if not given.held_out:  # kind by kind, so that what is done is kept
            write_measurements(OUT, [*others(OUT, measured), *measured])


def _rows(
    kind: str, robot: Varied, made: Sequence[Tracking], plans: Sequence[tuple[int, GaitPlan]]
) -> Iterator[Row]:
    succeeded = []
    for each, (number, plan) in zip(made, plans, strict=True):
        off = each.com[:2] - plan.goal - place_of(number)[:2]
        stands = each.outcome in ("followed", "astray", "time")
        succeeded.append(stands and bool(np.hypot(*off) <= NEAR))
        print(
            f"{kind} {len(succeeded) - 1}: {each.outcome} {each.cause} after {each.time:.1f} s in"
            f" support {each.support} of {plan.length}; FTS {each.fts:.3f}, FTER {each.fter:.4f} m",
            file=sys.stderr,
        )
    share = 100.0 * float(np.mean(succeeded))
    fts, fter = np.mean([each.fts for each in made]), np.nanmean([each.fter for each in made])
    published = PUBLISHED[robot].get(kind, (None, None, None))
    wanted = (SUCCESS.get(kind), published[1]) if robot == "nominal" else published[:2]
    end = "" if robot == "nominal" else f"_{robot}"
    for name in ("tracker", "controller"):  # the tracker is the best controller so far
        yield Row(f"{name}_{kind}_success{end}", "%", [share], published[0], wanted[0], "higher")
        yield Row(f"{name}_{kind}_fts{end}", "1", [float(fts)], published[1], wanted[1], "higher")
        yield Row(f"{name}_{kind}_fter{end}", "m", [float(fter)], published[2], None, "lower")


def _plans(given: argparse.Namespace, kind: str) -> Planned:
    """Return fields by number, and plans to goals 2 to 5 m away, with the field of each."""
    config = GaitPlanningConfig(goal_radius=INSIDE)
    ground, starts = starts_on(
        *(config, kind, 8 * given.episodes, given.episodes + given.spare),
        *(given.held_out, given.shift),
    )
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
    count, robot = len(together), varied_robot(given.robot)
    coms = together.at(np.zeros(count)).com
    start, _ = standing_with(robot.body, coms, together.yaws[:, 0], together.feet[:, 0])
    physics = make_physics(robot.body, count, world_of(fields), robot.variation(count))
    walk = Walk(physics, PhaseTracker(body, together, settings))
    with Progress(round(SECONDS / TICK), unit="ticks") as progress:
        seen = itertools.count(1)

        def show(ticked: Ticked, command: np.ndarray) -> None:
            del ticked, command
            if (tick := next(seen)) % SHOWN == 0:
                progress.update(tick)

        return track(walk, start, SECONDS, show)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.gait_tracking", description=__doc__)
    parser.add_argument("--episodes", type=int, default=20)
    parser.add_argument("--spare", type=int, default=5)
    parser.add_argument("--kinds", nargs="+", choices=FIELD_KINDS, default=list(SUCCESS))
    parser.add_argument("--robot", choices=VARIED, default="nominal")
    parser.add_argument("--speed", type=float, default=2.5)
    parser.add_argument("--shift", type=int, default=0)
    parser.add_argument("--held-out", action="store_true")
    return parser


if __name__ == "__main__":
    sys.exit(run_guarded(lambda: main(sys.argv[1:])))
