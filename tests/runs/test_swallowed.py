"""Ctrl-C at the moments when Python ignores exceptions: it is not lost."""

import gc
import signal
import sys
import time
import weakref
from concurrent.futures import ThreadPoolExecutor

import pytest

from jaxleas.cli_guard import INTERRUPTED, run_guarded
from jaxleas.runs.interruption import Interruption, interrupts_deferred

LONG = 10.0  # [s]


class Thing:
    """Something that can be referred to weakly."""


class Dying:
    """Something during whose last moments Ctrl-C is pressed."""

    def __del__(self) -> None:
        press()


def press(*_: object) -> None:
    signal.raise_signal(signal.SIGINT)
    for _ in range(10):  # Python looks for signals between its instructions
        pass


def in_weakref_callback() -> None:
    thing = Thing()
    reference = weakref.ref(thing, press)
    del thing
    assert reference() is None


def in_del() -> None:
    Dying()


def in_garbage_collection() -> None:
    ring = Dying()
    ring.ring = ring  # type: ignore[attr-defined]
    del ring
    gc.collect()


def in_callback_of_the_collector() -> None:
    def once(phase: str, info: dict) -> None:
        gc.callbacks.remove(once)
        press()

    gc.callbacks.append(once)
    gc.collect()


MOMENTS = (in_weakref_callback, in_del, in_garbage_collection, in_callback_of_the_collector)


@pytest.fixture(autouse=True)
def argv(monkeypatch):
    monkeypatch.setattr(sys, "argv", ["jaxleas"])


@pytest.mark.parametrize("moment", MOMENTS)
def test_ctrl_c_ends_the_command_wherever_it_falls(moment, capsys):
    went_on = []

    def command() -> None:
        moment()
        time.sleep(LONG)
        went_on.append(True)

    begun, hook = time.monotonic(), sys.unraisablehook
    assert run_guarded(command) == INTERRUPTED
    assert not went_on
    assert time.monotonic() - begun < LONG
    assert "ignored" not in capsys.readouterr().err
    assert sys.unraisablehook is hook


def test_swallowed_again_and_again_it_is_raised_in_the_end():
    def command() -> None:
        for _ in range(5):
            in_weakref_callback()
        time.sleep(LONG)

    assert run_guarded(command) == INTERRUPTED


def test_a_training_that_has_begun_meanwhile_stops_where_it_can_go_on():
    requested = []

    def command() -> None:
        in_weakref_callback()
        with Interruption() as interruption:
            until = time.monotonic() + LONG
            while not interruption.requested and time.monotonic() < until:
                time.sleep(0.01)
            requested.append(interruption.requested)

    assert run_guarded(command) == 0
    assert requested == [True]


def test_a_second_ctrl_c_acts_at_once_also_in_a_callback():
    def command() -> None:
        with Interruption() as interruption:
            press()
            assert interruption.requested
            in_weakref_callback()
            time.sleep(LONG)

    assert run_guarded(command) == INTERRUPTED


def test_a_command_that_is_done_is_not_interrupted_any_more():
    def command() -> None:
        in_weakref_callback()

    assert run_guarded(command) == 0
    time.sleep(0.1)


def test_other_exceptions_that_python_ignores_are_reported_as_before(monkeypatch):
    seen = []
    monkeypatch.setattr(sys, "unraisablehook", lambda lost: seen.append(lost.exc_type))

    def command() -> None:
        thing = Thing()
        reference = weakref.ref(thing, lambda _: 1 // 0)
        del thing
        assert reference() is None

    assert run_guarded(command) == 0
    assert seen == [ZeroDivisionError]


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_deferred_signal_acts_after_the_import(number):
    """A signal during an import in C can abort the process: it acts when that is complete."""
    seen, done = [], []

    def note(caught: int, frame: object) -> None:
        seen.append((caught, list(done)))

    before = signal.signal(number, note)
    try:
        with interrupts_deferred():
            signal.raise_signal(number)
            for _ in range(10):
                pass
            done.append("imported")
        assert seen == [(number, ["imported"])]
        with interrupts_deferred():
            pass
        assert len(seen) == 1
        assert signal.getsignal(number) is note
    finally:
        signal.signal(number, before)


def test_interrupts_are_deferred_in_the_main_thread_alone():
    with ThreadPoolExecutor(1) as pool:
        assert pool.submit(_passed).result()


def _passed() -> bool:
    with interrupts_deferred():
        return True
