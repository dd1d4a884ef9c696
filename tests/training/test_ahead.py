"""The host is never more than some updates ahead of the devices: XLA:CPU hangs where it is."""

from itertools import islice

import jax
import jax.numpy as jnp

from jaxleas.training.stretches import MOST_AHEAD, Schedule, Stretch, stretches

SCHEDULE = Schedule(updates=3 * MOST_AHEAD, every=1000)


def begin(begun):
    while True:
        begun.append(len(begun) + 1)
        yield {"update": jnp.int32(begun[-1])}


def test_the_host_waits_before_it_is_too_far_ahead(monkeypatch):
    begun, waited, ahead = [], [0], []

    def updates():
        for metrics in begin(begun):
            ahead.append(begun[-1] - waited[-1])
            yield metrics

    monkeypatch.setattr(
        jax, "block_until_ready", lambda metrics: waited.append(int(metrics["update"]))
    )
    (stretch,) = stretches(updates(), SCHEDULE, 0, lambda: False)
    assert len(begun) == stretch.done == len(stretch.rows) == SCHEDULE.updates
    assert max(ahead) == MOST_AHEAD


def test_examinations_are_due_at_intervals_and_after_the_last_update():
    found = list(stretches(begin([]), Schedule(updates=11, every=4), 2, lambda: False))
    assert [(each.done, each.due) for each in found] == [(4, True), (8, True), (11, True)]
    assert [update for each in found for update, _ in each.rows] == list(range(3, 12))


def test_slow_updates_are_handed_over_one_by_one():
    found = list(stretches(begin([]), Schedule(3, 2, one_by_one=True), 0, lambda: False))
    assert [(each.done, each.due, len(each.rows)) for each in found] == [
        (1, False, 1),
        (2, True, 1),
        (3, True, 1),
    ]


def test_asked_to_stop_what_was_done_is_handed_over_and_no_more_begun():
    begun = []
    (stretch,) = stretches(begin(begun), Schedule(11, 4), 0, lambda: len(begun) == 3)
    assert (stretch.done, stretch.due, len(stretch.rows)) == (3, False, 3)
    assert begun == [1, 2, 3]


def test_updates_that_end_before_the_training_does_are_handed_over():
    ended = islice(begin([]), 2)
    assert list(stretches(ended, Schedule(11, 4), 4, lambda: False)) == [
        Stretch(6, [(5, {"update": 1}), (6, {"update": 2})], due=False)
    ]
