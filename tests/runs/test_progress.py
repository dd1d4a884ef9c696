import io

import pytest

from jaxleas.runs.progress import Progress, _clock


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


@pytest.fixture(autouse=True)
def environment(monkeypatch) -> None:
    for name in ("CI", "NO_COLOR"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("TERM", "xterm")


def test_without_a_terminal_lines_are_plain_and_rare() -> None:
    stream = io.StringIO()
    with Progress(1000, every_seconds=3600.0, stream=stream) as progress:
        progress.say("compiling")
        for step in range(0, 1001, 10):
            progress.update(step, {"return": "1.5"})
    first, last = stream.getvalue().splitlines()
    assert first == "compiling"
    assert last.startswith("100 %  1,000 steps  ")
    assert "return 1.5" in last
    assert "\x1b" not in stream.getvalue()


def test_lines_come_as_often_as_asked() -> None:
    stream = io.StringIO()
    with Progress(4, every_seconds=0.0, stream=stream) as progress:
        for step in range(1, 5):
            progress.update(step)
    assert len(stream.getvalue().splitlines()) == 4


def test_in_a_terminal_the_line_is_live_and_the_cursor_comes_back() -> None:
    stream = Terminal()

    def interrupted() -> None:
        with Progress(10, stream=stream) as progress:
            progress.update(5, {"held out": "98 %"})
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    text = stream.getvalue()
    assert "held out 98 %" in text
    assert text.rindex("\x1b[?25h") > text.rindex("\x1b[?25l")


@pytest.mark.parametrize("name", ["CI", "NO_COLOR"])
def test_ci_and_no_color_make_it_plain(monkeypatch, name: str) -> None:
    monkeypatch.setenv(name, "true")
    stream = Terminal()
    with Progress(10, stream=stream) as progress:
        progress.update(10)
    assert "\x1b" not in stream.getvalue()


def test_resuming_counts_only_new_steps_as_speed(monkeypatch) -> None:
    now = [100.0]
    monkeypatch.setattr("jaxleas.runs.progress.time.monotonic", lambda: now[0])
    stream = io.StringIO()
    with Progress(2000, start=1000, stream=stream) as progress:
        now[0] += 5.0
        progress.update(1500)
    assert stream.getvalue() == " 75 %  1,500 steps  100 steps/s  0:05 left\n"


def test_time_spent_compiling_does_not_spoil_the_speed(monkeypatch) -> None:
    now = [0.0]
    monkeypatch.setattr("jaxleas.runs.progress.time.monotonic", lambda: now[0])
    stream = io.StringIO()
    with Progress(3000, stream=stream) as progress:
        for seconds in (60.0, 1.0, 1.0):
            now[0] += seconds
            progress.update(progress._done + 1000)
    assert "1,000 steps/s" in stream.getvalue().splitlines()[-1]


@pytest.mark.parametrize(
    ("seconds", "text"), [(0, "0:00"), (59.6, "1:00"), (3661, "1:01:01"), (float("inf"), "?")]
)
def test_clock(seconds: float, text: str) -> None:
    assert _clock(seconds) == text
