"""The proof that an exhausted search leaves behind: the sets that it kept, and which lead where."""

from jaxleas.contacts.infeasibility import InfeasibilityProof, ProofSet
from jaxleas.contacts.search.decide_by_sets import SetsDecision
from jaxleas.contacts.search.forward_sets import NOWHERE, PlaceSet
from jaxleas.contacts.search.hopeless import possible_pairs


def proof_of(found: SetsDecision) -> InfeasibilityProof:
    """Return the proof of a search that ended without a plan.

    Sets that others hold are replaced by these. A surface that leads nowhere is one set, the whole
    surface, from which steps lead to other such surfaces or nowhere.

    Args:
        found: decision of the search, "infeasible".
    """
    return _Writer(found).write()


class _Writer:
    """Gives the sets numbers in the order in which they are reached from the first."""

    def __init__(self, found: SetsDecision) -> None:
        assert found.sets is not None
        assert found.advance is not None
        self._found, self._sets, self._advance = found, found.sets, found.advance
        self._numbers: dict[PlaceSet, int] = {}
        self._order: list[PlaceSet] = []
        self._wholes: dict[tuple[int, str], PlaceSet] = {}
        self._shorts: dict[tuple[int, str], PlaceSet | None] = {}
        self._short_sets: set[PlaceSet] = set()
        self._possible: dict[tuple, list[str]] = {}

    def write(self) -> InfeasibilityProof:
        """Return the sets that can be reached."""
        self._number(self._sets.start)
        written: list[ProofSet] = []
        while len(written) < len(self._order):
            held = self._order[len(written)]
            leads = {name: self._number(each) for name, each in self._leads(held).items()}
            written.append(ProofSet(held.step, held.surface, held.region.vertices, leads))
        return InfeasibilityProof(tuple(written))

    def _number(self, held: PlaceSet) -> int:
        if held not in self._numbers:
            self._numbers[held] = len(self._order)
            self._order.append(held)
        return self._numbers[held]

    def _leads(self, held: PlaceSet) -> dict[str, PlaceSet]:
        move, leading = self._sets.moves[held.step], self._found.leading
        if held.surface not in leading[held.step]:
            return self._from_whole(held)
        if held in self._short_sets or (held.step == 0 and self._advance.falls_short(held)):
            return self._from_short(held)
        leads = {}
        if move.changes:
            for name in self._sets.near(held):
                if name not in leading[held.step + 1]:
                    leads[name] = self._whole(held.step + 1, name)
        for image in self._found.images.get(held, ()):
            if self._advance.falls_short(image):
                short = self._short(image.step, image.surface)
                assert short is not None
                leads[image.landed] = short
                continue
            others = self._found.kept[image.step, image.surface]
            leads[image.landed] = min(others, key=lambda each: each.region.outside(image.region))
        return leads

    def _from_whole(self, held: PlaceSet) -> dict[str, PlaceSet]:
        move = self._sets.moves[held.step]
        key = held.surface, id(move.body), move.candidates
        if key not in self._possible:
            (row,) = possible_pairs(self._sets, (held.surface,), move)
            self._possible[key] = [move.candidates[index] for index in row.nonzero()[0]]
        return {
            name: self._whole(held.step + 1, name if move.changes else held.surface)
            for name in self._possible[key]
        }

    def _from_short(self, held: PlaceSet) -> dict[str, PlaceSet]:
        """Return where steps lead that stay too far from the goal, however far they go."""
        move, leads = self._sets.moves[held.step], {}
        if held.step + 1 == len(self._sets.problem):
            return {}
        for name in self._sets.near(held):
            after = name if move.changes else held.surface
            hopeless = after not in self._found.leading[held.step + 1]
            if hopeless:
                leads[name] = self._whole(held.step + 1, after)
            elif (short := self._short(held.step + 1, after)) is not None:
                leads[name] = short
        return leads

    def _short(self, step: int, name: str) -> PlaceSet | None:
        key = step, name
        if key not in self._shorts:
            made = self._advance.short(self._sets, step, name)
            self._shorts[key] = made
            if made is not None:
                self._short_sets.add(made)
        return self._shorts[key]

    def _whole(self, step: int, name: str) -> PlaceSet:
        key = step, name
        if key not in self._wholes:
            region = self._sets.start.region if name == NOWHERE else self._sets.whole(name)
            self._wholes[key] = PlaceSet(step, name, region)
        return self._wholes[key]
