"""A beam search for crawls: many robots at once, every transition decided by CROC.

After each phase the few most promising states of each robot are kept, none twice.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from jaxleas.envs.gait_planning import (
    GaitPlanningConfig,
    PlanningState,
    base_distance,
    candidate_of,
    decide_phases,
    footholds_are_safe,
    reach_slack,
    trunk_is_free,
)
from jaxleas.gaits.crawl_settings import CrawlSettings
from jaxleas.gaits.gait import Ending, Gait, gait_of, no_commands, taken
from jaxleas.gaits.layer import Layer, promising
from jaxleas.gaits.moves import Moves, command_of_moves, moves_from
from jaxleas.gaits.promise import promise
from jaxleas.gaits.wished_footholds import Footing, wish_footholds

TIMES = ((1.0, 1.0), (0.6, 1.6), (1.6, 0.6))
"""Times t_E* and t_S that are tried, one after another [s]."""
LEAST_REACH = 0.002  # a slack of reach too small for any margin [m]


def search_crawls(
    config: GaitPlanningConfig,
    footing: Footing,
    starts: PlanningState,
    settings: CrawlSettings | None = None,
    say: Callable[[int, int], None] = lambda phases, open_: None,
) -> list[Gait]:
    """Return a crawl of each robot to its goal, or to where its search came nearest.

    Args:
        config: configuration of the task.
        footing: ground.
        starts: states to begin with, with their goals.
        settings: settings of the search.
        say: function that is told after each phase its number and how many robots are on their way.
    """
    chosen = settings or CrawlSettings()
    count = len(starts.step)
    owner = np.arange(count)
    layers = [Layer(starts, owner, owner, no_commands(), promise(config, starts))]
    seen: list[set[bytes]] = [set() for _ in range(count)]
    ends: dict[int, tuple[int, int]] = {}
    for phases in range(1, chosen.most_phases + 1):
        layer = layers[-1]
        open_ = np.flatnonzero(~np.isin(layer.owner, list(ends)))
        say(phases, len(set(layer.owner[open_].tolist())))
        if not len(open_):
            break
        after = _children(config, footing, chosen, layer, open_)
        after = after.kept(promising(after, seen, chosen.width))
        layers.append(after)
        near = base_distance(after.states.phase, after.states.goal) < config.goal_radius
        for place in np.flatnonzero(near):
            ends.setdefault(int(after.owner[place]), (phases, int(place)))
    return [_way(layers, robot, ends.get(robot), chosen) for robot in range(count)]


def _children(
    config: GaitPlanningConfig,
    footing: Footing,
    settings: CrawlSettings,
    layer: Layer,
    open_: np.ndarray,
) -> Layer:
    """Return the states that moves from the open states of a layer lead to, all feasible."""
    states = taken(layer.states, open_)
    moves = moves_from(config, settings, states, wish_footholds(config, footing, settings, states))
    row, move = np.nonzero(np.isfinite(moves.score))
    parents = taken(states, row)
    command = command_of_moves(config, parents, Moves(*(part[row, move] for part in moves)))
    candidates = candidate_of(config, footing.ground, parents, command)
    fits = footholds_are_safe(footing.ground, parents.field, candidates)
    fits &= trunk_is_free(config.robot, footing.ground, parents.field, candidates)
    fits &= reach_slack(config.robot, candidates) > LEAST_REACH
    feasible, times = np.zeros(len(row), bool), command.times.copy()
    for tried in TIMES:
        asked = fits & ~feasible
        times[asked] = tried
        feasible |= decide_phases(config, parents.phase, candidates, times, asked)[0]
    good = np.flatnonzero(feasible)
    step = parents.step + 1
    children = replace(taken(parents, good), phase=taken(candidates, good), step=step[good])
    return Layer(
        children,
        layer.owner[open_][row[good]],
        open_[row[good]],
        taken(command._replace(times=times), good),
        promise(config, children),
    )


def _way(
    layers: list[Layer], robot: int, end: tuple[int, int] | None, settings: CrawlSettings
) -> Gait:
    """Return the way to a robot's end, or to the most promising state that was kept."""
    ending: Ending = "reached"
    if end is None:
        last = len(layers) - 1
        is_open = bool(np.any(layers[last].owner == robot))
        ending = "budget" if is_open and last == settings.most_phases else "no move"
        mine = [
            (layer.worth[place], number, int(place))
            for number, layer in enumerate(layers)
            for place in np.flatnonzero(layer.owner == robot)
        ]
        _, number, place = max(mine)
        end = number, place
    number, place = end
    states, commands = [], []
    for layer in reversed(layers[: number + 1]):
        states.append(taken(layer.states, [place]))
        if len(layer.commands.turn):  # those of the start have none
            commands.append(taken(layer.commands, [place]))
        place = int(layer.parent[place])
    return gait_of(ending, states[::-1], commands[::-1])
