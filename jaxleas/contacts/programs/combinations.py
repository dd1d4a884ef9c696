"""Combinations of surfaces, cheapest first, learning from failures.

When a combination fails, a linear program says which steps are to blame: whatever the others do,
these surfaces together do not work. From then on such combinations are skipped, and of each
only the neighbours that change one of the steps to blame are visited. That loses none: on the
way from a combination to one that works, some step to blame has to change.

So a step that the relaxation decided keeps its surface until a failure blames it.
"""

import heapq
from collections.abc import Iterator

import numpy as np
from jaxtyping import Float

MOST_PASSED_OVER = 200_000
"""Number of combinations, tried or skipped, after which the search ends."""


class Combinations:
    """One surface per step, cheapest sum of slacks first.

    Attributes:
        exhausted: whether every combination has been yielded or refuted.
    """

    def __init__(
        self,
        candidates: list[tuple[str, ...]],
        slack: tuple[Float[np.ndarray, " c"], ...],
    ) -> None:
        """Sort the candidates of each step.

        Args:
            candidates: candidates of each step.
            slack: distance of the relaxed foothold from each of them [m].
        """
        self._options: list[list[tuple[float, str]]] = []
        for names, distances in zip(candidates, slack, strict=True):
            order = np.argsort(distances, kind="stable")
            self._options.append([(float(distances[i]), names[i]) for i in order])
        start = tuple(0 for _ in candidates)
        self._heap = [(sum(each[0][0] for each in self._options), start)]
        self._seen = {start}
        self._refuted: dict[tuple[int, ...], set[tuple[int, ...]]] = {}
        self._now = start
        self.exhausted = False

    def __iter__(self) -> Iterator[tuple[str, ...]]:
        """Yield the combinations that no call of `refute` excludes."""
        for _ in range(MOST_PASSED_OVER):
            if not self._heap:
                self.exhausted = True
                return
            cost, self._now = heapq.heappop(self._heap)
            if self._to_change() is None:
                yield tuple(
                    each[rank][1] for each, rank in zip(self._options, self._now, strict=True)
                )
            self._look_at_neighbours(cost)

    def refute(self, steps: tuple[int, ...]) -> None:
        """Record that the last combination fails because of its surfaces in these steps."""
        ranks = tuple(self._now[step] for step in steps)
        self._refuted.setdefault(steps, set()).add(ranks)

    def _to_change(self) -> tuple[int, ...] | None:
        """Return steps of which one must change; None if nothing is refuted."""
        for steps, refuted in self._refuted.items():
            if tuple(self._now[step] for step in steps) in refuted:
                return steps
        return None

    def _look_at_neighbours(self, cost: float) -> None:
        blamed = self._to_change()
        if blamed is None:  # it was tried without a refutation: any step may be to blame
            blamed = tuple(range(len(self._options)))
        for step in blamed:
            options, rank = self._options[step], self._now[step] + 1
            following = (*self._now[:step], rank, *self._now[step + 1 :])
            if rank < len(options) and following not in self._seen:
                self._seen.add(following)
                more = options[rank][0] - options[rank - 1][0]
                heapq.heappush(self._heap, (cost + more, following))
