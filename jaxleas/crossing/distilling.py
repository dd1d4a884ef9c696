"""Distils a planner into a proposal: it chooses, the proposal walks, it says what it had chosen.

As steering is distilled from a contact planner (docs/distillation.md): rounds of labels, fit, and
walks, with the exact planner as the judge of what was learned.
"""

import hashlib
import json
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np

from jaxleas.crossing.lesson_file import LessonNotes, LessonRows, read_lesson, write_lesson
from jaxleas.crossing.lesson_walk import School, walk_lesson
from jaxleas.crossing.lessons import make_lesson
from jaxleas.footsteps import (
    Choices,
    Proposal,
    ProposalFit,
    ProposalSight,
    agreement,
    fit_proposal,
    motion_digest,
    read_proposal,
    write_proposal,
)
from jaxleas.types import InputError

EACH_FOR_CHECK = 8
"""Of so many lessons one is not learned from: how often the proposal agrees there is reported."""


@dataclass(frozen=True)
class DistillSettings:
    """How much is asked, and how it is learned.

    Attributes:
        rounds: number of rounds after the first, in which the proposal walks.
        lessons: lessons of the first round, in which the planner walks.
        more: lessons of each round after it.
        robots: robots that walk a lesson at once.
        seconds: time after which a lesson ends [s].
        share: share of the contacts at which the planner is asked while the proposal walks.
        epochs: times that each choice is learned from.
    """

    rounds: int = 3
    lessons: int = 40
    more: int = 30
    robots: int = 6
    seconds: float = 30.0
    share: float = 0.5
    epochs: int = 30

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


class Distillation:
    """Rounds in a folder; what is there is not done again.

    Args:
        folder: folder of lessons and proposals.
        school: what lessons are walked with.
        settings: how much is asked, and how it is learned.
        tick: function called at each tick of a lesson with its number.
        say: function that says a sentence.
    """

    def __init__(
        self,
        folder: Path,
        school: School,
        settings: DistillSettings,
        tick: Callable[[int], None],
        say: Callable[[str], None],
    ) -> None:
        self._folder, self._school, self._settings = folder, school, settings
        self._tick, self._say = tick, say
        self._learned: dict[int, Choices] = {}

    def run(self) -> tuple[Proposal, list[DistillRound]]:
        """Return the proposal of the last round, and what came of all."""
        proposal, rounds = None, []
        for number in range(self._settings.rounds + 1):
            proposal, found = self._round(number, proposal)
            self._say(found.in_words())
            rounds.append(found)
        assert proposal is not None
        return proposal, rounds

    def _round(self, number: int, before: Proposal | None) -> tuple[Proposal, DistillRound]:
        key, notes = self._key(before), []
        lessons = self._settings.numbers(number)
        for lesson in lessons:
            rows, note = self._lesson(lesson, before, key)
            notes.append(note)
            if len(rows):
                self._learned[lesson] = self._seen(lesson, rows)
        path = self._folder / f"proposal_{number}.npz"
        kept, held_out = self._split()
        if path.is_file():
            proposal = read_proposal(path)
            proposal.require_fits(self._school.model, str(path))
        else:
            self._say(f"round {number}: fits {len(kept)} choices")
            fit = ProposalFit(epochs=self._settings.epochs, seed=number)
            proposal = fit_proposal(kept, self._school.model, fit)
            write_proposal(path, proposal)
        outcomes = Counter(each for note in notes for each in note.outcomes)
        return proposal, DistillRound(
            number=number,
            choices=sum(len(self._learned[each]) for each in lessons if each in self._learned),
            reached=outcomes["reached"],
            robots=outcomes.total(),
            asked=sum(each.asked for each in notes),
            searched=sum(each.searched for each in notes),
            agreed=agreement(proposal, held_out),
        )

    def _lesson(
        self, number: int, before: Proposal | None, key: str
    ) -> tuple[LessonRows, LessonNotes]:
        path = self._folder / f"lesson_{number:05d}.npz"
        if path.is_file():
            return read_lesson(path, key)
        rows, notes = walk_lesson(
            self._school, make_lesson(number), before, key, lambda: self._tick(number)
        )
        write_lesson(path, rows, notes)
        return rows, notes

    def _seen(self, lesson: int, rows: LessonRows) -> Choices:
        """Return what a proposal sees in the states of a lesson."""
        model = self._school.model
        commands = model.commands()
        sight = ProposalSight(model, self._school.costs(make_lesson(lesson)), commands)
        seen = [sight.of(rows.node(row), rows.goal_of(row)) for row in range(len(rows))]
        apart = np.abs(rows.chosen[:, None] - commands).sum(axis=2)
        return Choices(
            np.stack([each.commands for each in seen]).astype(np.float16),
            np.stack([each.state for each in seen]),
            apart.argmin(axis=1),
        )

    def _split(self) -> tuple[Choices, Choices]:
        """Return the choices that are learned from, and those that are not."""
        last = EACH_FOR_CHECK - 1
        kept = [each for lesson, each in self._learned.items() if lesson % EACH_FOR_CHECK != last]
        others = [each for lesson, each in self._learned.items() if lesson % EACH_FOR_CHECK == last]
        if not kept or not others:
            raise InputError("the planner found no command in any lesson: nothing can be learned")
        return _joined(kept), _joined(others)

    def _key(self, before: Proposal | None) -> str:
        """Return the digest of everything that a lesson depends on, besides its number."""
        school = self._school
        weights = None if before is None else [before.of_command.tobytes(), before.last.tobytes()]
        known = {
            "controller": asdict(school.controller.identity),
            "motion": motion_digest(school.model),
            "settings": asdict(school.settings),
            "robots": school.robots,
            "share": school.share,
            "before": None if weights is None else hashlib.sha256(b"".join(weights)).hexdigest(),
        }
        return hashlib.sha256(json.dumps(known, sort_keys=True).encode()).hexdigest()


def _joined(parts: Sequence[Choices]) -> Choices:
    names = ("commands", "state", "chosen")
    return Choices(*(np.concatenate([getattr(each, name) for each in parts]) for name in names))


def with_provenance(proposal: Proposal, rounds: Sequence[DistillRound], origin: dict) -> Proposal:
    """Return a proposal that says how it was taught."""
    return replace(proposal, provenance={"rounds": [asdict(each) for each in rounds], **origin})
