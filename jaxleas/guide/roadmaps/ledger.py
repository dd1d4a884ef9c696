"""Connections with their answers: a search asks for one at a time, and batches are tried."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from jaxleas.guide.roadmaps.budget import Budget
from jaxleas.guide.roadmaps.connections import BATCH, Connector, one
from jaxleas.types import RootMotion

Key = tuple[float, float]
"""A place, rounded so that equal places have equal keys [m]."""


def key_of(place: Sequence[float] | np.ndarray) -> Key:
    """Return a place as a key, rounded to a nanometre."""
    return round(float(place[0]), 9), round(float(place[1]), 9)


@dataclass(frozen=True)
class Question:
    """The question whether a robot at `origin` that moves with `motion` gets to `target`.

    Attributes:
        origin: place where the robot starts.
        target: place to get to.
        motion: root motion at the start.
        arrived_by: number of the answer that brought the robot to `origin`; -1 if it began there or
            if the way it arrived does not matter.
    """

    origin: Key
    target: Key
    motion: RootMotion
    arrived_by: int = -1


@dataclass(frozen=True)
class Answer:
    """The answer to a question.

    Attributes:
        number: number of the answer, in order.
        reached: whether the target was reached, valid all the way.
        arrival: root motion at the end.
    """

    number: int
    reached: bool
    arrival: RootMotion


@dataclass
class Ledger:
    """Answers by question; a new question is answered together with guesses of the next ones.

    A search asks for one connection, and the next question depends on the answer. A batch of
    `BATCH` connections takes hardly longer than one, though: so each new question is tried together
    with the questions that will probably follow.

    Attributes:
        connector: connector that tries connections.
        budget: budget that pays once for each question asked, and not for guesses.
        banned: connections that failed when a whole path was followed.
        tried: number of connections walked, guesses included.
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
            question: question to answer.
            guesses: function that returns the questions that may come next; called only for a new
                question.
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
