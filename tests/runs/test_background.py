"""Jobs off the hot path: in order, bounded, their errors raised, none left undone."""

import threading
import time

import pytest

from jaxleas.runs.background import Background


def test_jobs_are_done_in_order_and_all_of_them():
    done = []
    with Background(waiting=1) as background:
        for number in range(50):
            background.submit(lambda number=number: done.append(number))
    assert done == list(range(50))


def test_whoever_submits_need_not_wait_until_too_many_do():
    gate, done = threading.Event(), []

    def slow() -> None:
        gate.wait(5)
        done.append(1)

    with Background(waiting=1) as background:
        background.submit(slow)
        background.submit(slow)
        assert done == []
        threading.Timer(0.05, gate.set).start()
        begun = time.monotonic()
        background.submit(slow)  # no room: waits for the first
        assert time.monotonic() - begun > 0.03
    assert done == [1, 1, 1]


def test_an_error_comes_up_and_what_came_after_is_not_done():
    done, failed = [], threading.Event()

    def fail() -> None:
        failed.set()
        raise OSError(28, "No space left on device")

    background = Background()
    background.submit(fail)
    background.submit(lambda: done.append(1))
    failed.wait(5)
    with pytest.raises(OSError, match="No space left"):
        background.close()
    assert done == []
    background.close()  # said once


def test_leaving_by_an_interruption_waits_for_what_is_under_way():
    done = []

    def slow() -> None:
        time.sleep(0.05)
        done.append(1)

    def interrupted() -> None:
        with Background() as background:
            background.submit(slow)
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert done == [1]
