"""What is known of connections: asked for one at a time by a search, tried many at a time."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from jaxleas.guide.roadmaps.budget import Budget
from jaxleas.guide.roadmaps.connections import BATCH, Connector, one
from jaxleas.types import RootMotion

Key = tuple[float, float]
"""A place, rounded so that it is found again [m]."""


def key_of(place: Sequence[float] | np.ndarray) -> Key:
    """Return a place as a key; to a nanometre."""
    return round(float(place[0]), 9), round(float(place[1]), 9)


@dataclass(frozen=True)
class Question:
    """Can a robot that stands at `origin` as `motion` says get to `target`?

    Attributes:
        origin: place it stands at.
        target: place to get to.
        motion: of its root at the start.
        arrived_by: which answered question brought it to `origin`; -1: it began there, or any did.
    """

    origin: Key
    target: Key
    motion: RootMotion
    arrived_by: int = -1


@dataclass(frozen=True)
class Answer:
    """Whether the target was reached, and how the robot arrived there.

    Attributes:
        number: of the answer; counts up.
        reached: the target, valid all the way.
        arrival: root motion at the end.
    """

    number: int
    reached: bool
    arrival: RootMotion


@dataclass
class Ledger:
    """Answers by question; a miss is answered together with guesses of what comes next.

    A search asks for one connection, and the next question depends on the answer. A batch of
    `BATCH` connections takes hardly longer than one, though: so each miss is tried beside the
    questions that will probably follow.

    Attributes:
        connector: that tries connections.
        budget: from which each question asked (not each guess) is taken once.
        banned: connections that failed when a whole path was followed.
        tried: connections walked, guesses included.
    """

    connector: Connector
    budget: Budget
    banned: set[tuple[Key, Key]] = field(default_factory=set)
    tried: int = 0
    _answers: dict[tuple[Key, Key, int], Answer] = field(default_factory=dict)
    _asked: set[tuple[Key, Key, int]] = field(default_factory=set)

    def ask(self, question: Question, guesses: Callable[[], Sequence[Question]]) -> Answer:
        """Return the answer to a question.

        Args:
            question: to be answered.
            guesses: makes the questions that may come next; called only on a miss.
        """
        name = _name(question)
        if name not in self._asked:
            self._asked.add(name)
            self.budget.used += 1
        if name not in self._answers:
            fresh = {name: question}
            for guess in guesses():
                if len(fresh) < BATCH and _name(guess) not in self._answers:
                    fresh.setdefault(_name(guess), guess)
            self._try(list(fresh.values()))
        answer = self._answers[name]
        if (question.origin, question.target) in self.banned:
            return Answer(answer.number, False, answer.arrival)
        return answer

    def reached(self) -> list[tuple[Key, Key]]:
        """Return all connections that are known to work."""
        return [
            (origin, target)
            for (origin, target, _), answer in self._answers.items()
            if answer.reached and (origin, target) not in self.banned
        ]

    def _try(self, questions: list[Question]) -> None:
        targets = np.array([each.target for each in questions])
        tried = self.connector.connect([each.motion for each in questions], targets)
        self.tried += len(questions)
        for index, question in enumerate(questions):
            self._answers[_name(question)] = Answer(
                len(self._answers), bool(tried.reached[index]), one(tried.arrival, index)
            )


def _name(question: Question) -> tuple[Key, Key, int]:
    return question.origin, question.target, question.arrived_by
