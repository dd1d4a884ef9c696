"""Best-first search on small graphs, against Dijkstra's answer by another package."""

import networkx as nx
import numpy as np
import pytest

from jaxleas.contacts.search.best_first import BestFirst, Graph, OutOfTimeError


def random_graph(seed: int) -> tuple[nx.DiGraph, dict[int, float]]:
    """Return a weighted graph, and the distances from each node to node 0."""
    rng = np.random.default_rng(seed)
    graph = nx.DiGraph()
    graph.add_nodes_from(range(25))
    for one, other in rng.integers(0, 25, size=(70, 2)).tolist():
        graph.add_edge(one, other, weight=float(rng.uniform(0.1, 2.0)))
    distances = nx.single_source_dijkstra_path_length(graph.reverse(), 0)
    return graph, distances


@pytest.mark.parametrize("share", [0.0, 0.7, 1.0])
def test_the_first_goal_is_the_cheapest(share: float) -> None:
    found = 0
    for seed in range(12):
        graph, distances = random_graph(seed)
        search = BestFirst(
            Graph[int](
                successors=lambda n, g=graph: [(g[n][m]["weight"], m) for m in g[n]],
                heuristic=lambda n, d=distances, s=share: s * d.get(n, np.inf) if s else 0.0,
                is_goal=lambda n: n == 0,
                needs=_once(),
            )
        )
        goal = next(search.goals([24]), None)
        assert (goal is None) == (24 not in distances)
        if goal is None:
            continue
        found += 1
        path = goal.path()
        assert goal.cost == pytest.approx(distances[24])
        assert goal.cost == pytest.approx(nx.path_weight(graph, path, "weight"))
        assert (path[0], path[-1]) == (24, 0)
    assert 4 <= found < 12


def test_a_perfect_heuristic_expands_the_path_alone() -> None:
    for seed in range(12):
        graph, distances = random_graph(seed)
        search = BestFirst(
            Graph[int](
                successors=lambda n, g=graph: [(g[n][m]["weight"], m) for m in g[n]],
                heuristic=lambda n, d=distances: d.get(n, np.inf),
                is_goal=lambda n: n == 0,
                needs=_once(),
            )
        )
        goal = next(search.goals([24]), None)
        assert search.expansions == (0 if goal is None else len(goal.path()) - 1)


def _once():
    """Return a test that each state is needed once."""
    met = set()
    return lambda state: not (state in met or met.add(state))


def test_all_goals_come_in_the_order_of_their_costs() -> None:
    search = BestFirst(
        Graph[str](
            successors=lambda text: [(1.0 + (letter == "b"), text + letter) for letter in "ab"],
            heuristic=lambda text: 3.0 - len(text),
            is_goal=lambda text: len(text) == 3,
        )
    )
    goals = list(search.goals([""]))
    assert [goal.cost for goal in goals] == [3, 4, 4, 4, 5, 5, 5, 6]
    assert goals[0].path() == ["", "a", "aa", "aaa"]


def test_what_is_not_admitted_is_never_asked() -> None:
    asked = []

    def successors(number: int) -> list[tuple[float, int]]:
        asked.append(number)
        return [(1.0, 2 * number), (1.0, 2 * number + 1)]

    search = BestFirst(
        Graph[int](
            successors=successors,
            heuristic=lambda number: np.inf if number > 30 else 0.0,
            is_goal=lambda number: False,
            admits=lambda number: number % 3 != 0,
        )
    )
    assert not list(search.goals([1]))
    assert sorted(asked) == [1, 2, 4, 5, 8, 10, 11, 16, 17, 20, 22, 23]


def test_a_search_out_of_time_says_so() -> None:
    endless = Graph[int](
        successors=lambda number: [(1.0, number + 1)],
        heuristic=lambda number: 0.0,
        is_goal=lambda number: False,
    )
    with pytest.raises(OutOfTimeError):
        list(BestFirst(endless).goals([0], deadline=0.0))
