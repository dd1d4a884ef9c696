"""Which round was best: the most successful; of its like, the most robust."""

import pytest

from jaxleas.distillation.round_result import RoundResult, best_of
from jaxleas.distillation.rounds_file import read_rounds, write_rounds
from jaxleas.distillation.table import table_of


def result(number, success, robustness=None, starts=1000):
    cells = {"rubble 0°": success}
    return RoundResult(number, success, cells, 10, {"labels": 1.0}, None, starts, robustness)


@pytest.mark.parametrize(
    ("rounds", "best"),
    [
        # 99 % of 1000 starts are uncertain by 0.31 points.
        ([result(1, 0.99, 20.0), result(2, 0.988, 25.0)], 2),
        ([result(1, 0.99, 20.0), result(2, 0.986, 25.0)], 1),
        ([result(1, 1.0, 20.0), result(2, 0.999, 25.0), result(3, 1.0, 22.0)], 3),
        ([result(1, 0.99), result(2, 0.99), result(3, 0.988)], 1),
        ([result(1, 0.988), result(2, 0.99)], 2),
        # In tables of old it is not said how many starts there were.
        ([result(1, 0.99, 20.0, 0), result(2, 0.9899, 25.0, 0)], 1),
    ],
)
def test_the_best_round(rounds, best):
    assert best_of(rounds).round == best


def test_the_table_is_read_as_it_was_written_and_shown(tmp_path):
    rounds = [result(0, 0.5), result(1, 0.99, 21.25)]
    write_rounds(tmp_path / "rounds.json", rounds)
    assert read_rounds(tmp_path / "rounds.json") == rounds
    head, first, second = table_of(rounds).splitlines()
    assert head.split()[-2:] == ["robustness", "[N]"]
    assert first.split()[-2:] == ["50.0", "-"]
    assert second.split()[-2:] == ["99.0", "21.2"]
