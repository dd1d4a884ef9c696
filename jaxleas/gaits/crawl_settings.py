"""What the search for a crawl prefers."""

from dataclasses import dataclass


@dataclass(frozen=True)
class CrawlSettings:
    """Sizes and weights of the search for a crawl, tuned on fields that nothing is judged on.

    Attributes:
        width: number of states kept after each phase.
        moves: number of moves tried from each state.
        most_phases: length of a plan at which the search ends [phases].
        lead: distance of a wished foothold ahead of its nominal place [m].
        advance: way of the base for which footholds are wished [m].
        turn: largest turn of the base for which footholds are wished [rad].
        base_lead: distance of the base ahead of the mean of the feet [m].
        stable: distance of the centre of mass inside the feet below which a move is worse [m].
        reserve: slack of reach below which a move is worse [m].
    """

    width: int = 4
    moves: int = 10
    most_phases: int = 150
    lead: float = 0.16
    advance: float = 0.05
    turn: float = 0.25
    base_lead: float = 0.04
    stable: float = 0.035
    reserve: float = 0.02
