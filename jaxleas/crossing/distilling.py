"""Distils a planner into a proposal: it chooses, the proposal walks, it says what it had chosen.

As steering is distilled from a contact planner (docs/distillation.md): rounds of labels, fit, and
walks, with the exact planner as the judge of what was learned.
"""

import hashlib
import json
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np

from jaxleas.crossing.distill_rounds import EACH_FOR_CHECK, DistillRound, DistillSettings
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
