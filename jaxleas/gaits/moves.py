"""The moves that a search tries from a state: next supports, each with places of the base.

A move is judged as if the robot stood still: the centre of mass must lie inside the feet where the
support changes and where the phase ends. Of moves that pass, CROC accepts nearly all.
"""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from jaxleas.envs.gait_planning import (
    STANDING,
    Command,
    GaitPlanningConfig,
    PlanningState,
    bearing,
    in_contact,
    rotate,
)
from jaxleas.gaits.crawl_settings import CrawlSettings
from jaxleas.gaits.wished_footholds import Wishes, walking_share
from jaxleas.geometry import distance_inside

STEPS = np.stack(
    np.meshgrid(np.arange(-2, 6) * 0.04, np.arange(-4, 5) * 0.03, indexing="ij"), axis=-1
).reshape(-1, 2)
"""Steps of the base that are tried, ahead and to the left [m]."""
TURNS = (1.0, 0.5, 0.0)
"""Shares of the turn to the feet's heading that are tried."""
MOST_TURN = 0.2
"""Largest turn in a phase [rad]."""
RANKS = (0, 4, 12, 24)
"""Places in the order of one support's moves that are tried: neighbours are much alike."""
LEAST_SLACK = 0.004
"""Slack of reach that a move must have [m]."""
UNSTABLE, SHORT, ASKEW, GAIN, MOST_GAIN = 20.0, 4.0, 0.3, 1.5, 0.5
"""Prices of a missing metre inside the feet, of one of reach, and of a radian off the feet's
heading; worth of a metre by which a foot comes nearer to its wish, and the most that counts [m]."""


class Moves(NamedTuple):
    """Moves from each state, the best first.

    Attributes:
        score: how good each move is; minus infinity for none.
        step: step of the base in its present frame [m].
        turn: turn of the base [rad].
        support: next support.
        feet: feet afterwards [m].
    """

    score: Float[np.ndarray, "N M"]
    step: Float[np.ndarray, "N M 2"]
    turn: Float[np.ndarray, "N M"]
    support: np.ndarray
    feet: Float[np.ndarray, "N M 4 2"]


def moves_from(
    config: GaitPlanningConfig, settings: CrawlSettings, state: PlanningState, wishes: Wishes
) -> Moves:
    """Return the best moves from each state.

    Args:
        config: configuration of the task.
        settings: settings of the search.
        state: states of robots.
        wishes: wished footholds.
    """
    each = [_moves_to(config, settings, state, wishes, support) for support in range(len(STANDING))]
    moves = Moves(*(np.concatenate(parts, axis=1) for parts in zip(*each, strict=True)))
    order = np.argsort(-moves.score, axis=1, kind="stable")[:, : settings.moves]
    rows = np.arange(len(order))[:, None]
    return Moves(*(part[rows, order] for part in moves))


def command_of_moves(config: GaitPlanningConfig, state: PlanningState, moves: Moves) -> Command:
    """Return the commands of one move from each state, at rest in the end, 1 s on each support.

    Args:
        config: configuration of the task.
        state: states of robots.
        moves: moves without their axis M.
    """
    phase = state.phase
    base = phase.com[:, :2] + rotate(phase.yaw, moves.step)
    heading = phase.yaw.astype(np.float64) + moves.turn
    feet = rotate(-heading, moves.feet - base[:, None]) - config.robot.nominal[:, :2]
    reach = config.action.foot
    return Command(
        moves.turn,
        moves.step,
        np.zeros_like(moves.step),
        feet.clip(-reach, reach),
        np.ones((len(base), 2)),
        moves.support,
    )


def _moves_to(
    config: GaitPlanningConfig,
    settings: CrawlSettings,
    state: PlanningState,
    wishes: Wishes,
    support: int,
) -> Moves:
    """Return moves to one support: several of each state, not the best alone."""
    phase, count = state.phase, len(state.step)
    now, after = in_contact(phase.support), STANDING[support]
    yaw = phase.yaw.astype(np.float64)
    com, before = phase.com[:, :2].astype(np.float64), phase.feet[..., :2].astype(np.float64)
    feet = np.where((now & after)[..., None], before, wishes.place)
    heading = _heading_of(config, rotate(-yaw, feet - feet.mean(axis=1, keepdims=True)))
    share = walking_share(state)[:, None] * [settings.base_lead, 0.0]
    wished = feet.mean(axis=1) + rotate(yaw + heading, share)
    base = com[:, None] + rotate(yaw, STEPS[None])
    middle = 0.5 * (base + com[:, None])
    inside = np.minimum(
        distance_inside(middle, before[:, None], now[:, None]),
        np.minimum(
            distance_inside(middle, feet[:, None], after[None, None]),
            distance_inside(base, feet[:, None], after[None, None]),
        ),
    )
    possible = np.all(wishes.possible | ~after | (now & after), axis=1) & (phase.support != support)
    worth = np.zeros(count)
    if support:  # a foot is lifted: the one whose wish is far
        worth = GAIN * np.minimum(wishes.gain[:, support - 1], MOST_GAIN)
    worth = worth[:, None] - np.linalg.norm(base - wished[:, None], axis=-1)
    worth = worth - UNSTABLE * np.maximum(0.0, settings.stable - inside)
    ahead = np.clip(bearing(phase, state.goal), -settings.turn, settings.turn)
    score, turn = [], []
    for share_of_turn in TURNS:
        angle = np.clip(share_of_turn * (heading + 0.3 * ahead), -MOST_TURN, MOST_TURN)
        slack = _slack(config, feet[:, None] - base[:, :, None], yaw + angle, after)
        price = SHORT * np.maximum(0.0, settings.reserve - slack)
        price = price + ASKEW * np.abs(heading - angle)[:, None]
        fits = possible[:, None] & (slack > LEAST_SLACK) & (inside > 0.0)
        score.append(np.where(fits, worth - price, -np.inf))
        turn.append(np.broadcast_to(angle[:, None], fits.shape))
    scores, turns = np.concatenate(score, axis=1), np.concatenate(turn, axis=1)
    order = np.argsort(-scores, axis=1, kind="stable")[:, RANKS]
    rows = np.arange(count)[:, None]
    shape = order.shape
    return Moves(
        scores[rows, order],
        STEPS[order % len(STEPS)],
        turns[rows, order],
        np.full(shape, support),
        np.broadcast_to(feet[:, None], (*shape, 4, 2)),
    )


def _heading_of(
    config: GaitPlanningConfig, feet: Float[np.ndarray, "N 4 2"]
) -> Float[np.ndarray, " N"]:
    """Return the turn of the base that brings nominal feet nearest to the feet around it [rad]."""
    nominal = config.robot.nominal[:, :2]
    across = nominal[:, 0] * feet[..., 1] - nominal[:, 1] * feet[..., 0]
    return np.arctan2(across.sum(axis=1), (nominal * feet).sum(axis=(1, 2)))


def _slack(
    config: GaitPlanningConfig,
    feet: Float[np.ndarray, "N B 4 2"],
    yaw: Float[np.ndarray, " N"],
    standing: np.ndarray,
) -> Float[np.ndarray, "N B"]:
    """Return the least horizontal slack of reach of the feet in contact [m]."""
    low, high = (corner[:, :2] for corner in config.robot.reach_box)
    offset = rotate(-yaw, feet)
    slack = np.minimum(offset - low, high - offset).min(axis=-1)
    return slack[..., standing].min(axis=-1)
