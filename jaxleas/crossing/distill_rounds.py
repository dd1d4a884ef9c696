"""How much is asked in a distillation, and what comes of its rounds."""

from dataclasses import dataclass

from jaxleas.types import InputError

EACH_FOR_CHECK = 8
"""One lesson in every eight is held back: the proposal is judged by how often it agrees there."""


@dataclass(frozen=True)
class DistillSettings:
    """How much is asked, and how it is learned.

    Attributes:
        rounds: number of rounds after the first, in which the proposal walks.
        lessons: number of lessons in the first round, in which the planner walks.
        more: number of lessons in each later round.
        robots: number of robots that walk at once in a lesson.
        seconds: time after which a lesson ends [s].
        share: share of the contacts at which the planner is asked while the proposal walks.
        epochs: number of times that each choice is learned from.
    """

    rounds: int = 4
    lessons: int = 12
    more: int = 6
    robots: int = 6
    seconds: float = 30.0
    share: float = 0.5
    epochs: int = 25

    def __post_init__(self) -> None:
        counts = (self.lessons, self.more, self.robots, self.epochs)
        if min(counts) < 1 or self.rounds < 0 or not 0.0 < self.share <= 1.0:
            raise InputError(
                f"lessons {self.lessons}, more {self.more}, robots {self.robots}, epochs"
                f" {self.epochs}, rounds {self.rounds} and share {self.share:g}: give at least one"
                " of each of the first four, no negative rounds, and a share above 0, at most 1"
            )
        if not self.seconds > 0.0:
            raise InputError(f"lessons of seconds {self.seconds:g}: give more than 0")
        if self.lessons < EACH_FOR_CHECK:
            raise InputError(
                f"{self.lessons} lessons in the first round: give at least {EACH_FOR_CHECK}, of"
                " which one is not learned from"
            )

    def numbers(self, number: int) -> range:
        """Return the numbers of the lessons of a round."""
        if number == 0:
            return range(self.lessons)
        begin = self.lessons + (number - 1) * self.more
        return range(begin, begin + self.more)


@dataclass(frozen=True)
class DistillRound:
    """What came of a round.

    Attributes:
        number: number of the round; in round 0 the planner walked.
        choices: choices of the planner in this round.
        reached: robots that reached their last goal.
        robots: robots that walked.
        asked: plans that the proposal was asked for.
        searched: number of those that the planner searched for, since what was proposed was unsafe.
        agreed: share of choices, in lessons not learned from, that are the new proposal's, too.
    """

    number: int
    choices: int
    reached: int
    robots: int
    asked: int
    searched: int
    agreed: float

    def in_words(self) -> str:
        """Return the round as a sentence."""
        walker = "the planner" if self.number == 0 else f"proposal {self.number - 1}"
        share = f", searched {100 * self.searched / self.asked:.1f} %" if self.asked else ""
        return (
            f"round {self.number}: {walker} reached {self.reached} of {self.robots} goals{share};"
            f" {self.choices} choices; the new proposal agrees with {100 * self.agreed:.1f} %"
        )
