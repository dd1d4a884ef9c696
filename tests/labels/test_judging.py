"""The judge and its workers: in order, none lost, none twice, whoever dies."""

import os
import signal
import threading
import time
from dataclasses import replace
from pathlib import Path

import pytest

from jaxleas.labels import Here, Judge, MipSettings, ProcessWorkers, WorkerError, judge
from jaxleas.types import InputError
from tests.contacts.sampling.worlds import flat, hole, straight

PATHS = [straight(0.4 + 0.15 * n) for n in range(12)]
SCENES = [flat(), hole()]
INDEX = [n % 2 for n in range(12)]


def answer(verdict):
    return replace(verdict, seconds=0.0)


@pytest.fixture(scope="module")
def expected():
    return [
        answer(replace(judge("sl1m", SCENES[index], [path], robot="talos")[0], path=number))
        for number, (path, index) in enumerate(zip(PATHS, INDEX, strict=True))
    ]


def test_many_scenes_in_one_call_in_order(expected):
    counted = []
    with Judge("sl1m", robot="talos") as bench:
        verdicts = bench.judge(SCENES, PATHS, INDEX, counted.append)
        assert bench.judge(SCENES, [], []) == []
    assert [answer(verdict) for verdict in verdicts] == expected
    assert sum(counted) == len(PATHS)
    assert len(counted) > 1


def test_workers_stay_between_calls_and_the_work_of_one_that_dies_is_done_again(expected):
    workers = ProcessWorkers(2)
    with Judge("sl1m", workers=workers, robot="talos") as bench:
        assert list(map(answer, bench.judge(SCENES, PATHS, INDEX))) == expected
        team = workers.pids
        counted = []

        def kill_one(count):
            if not counted:
                os.kill(workers.pids[0], signal.SIGKILL)
            counted.append(count)

        assert list(map(answer, bench.judge(SCENES, PATHS, INDEX, kill_one))) == expected
        assert sum(counted) == len(PATHS)
        assert team[1] in workers.pids
        assert team[0] not in workers.pids
    assert workers.pids == []


def note_and_die_once(task: tuple[Path, int]) -> int:
    """Leave a mark of every try; the first try of task 2 kills its worker."""
    folder, number = task
    tries = len(list(folder.glob(f"{number}_*")))
    (folder / f"{number}_{tries}").touch()
    if number == 2 and tries == 0:
        os.kill(os.getpid(), signal.SIGKILL)
    return number * number


def note_and_die(task: tuple[Path, int]) -> int:
    folder, number = task
    (folder / f"{number}_{os.getpid()}").touch()
    if number == 1:
        os._exit(3)
    return number


def wait_for_ever(task: tuple[Path, int]) -> int:
    task[0].joinpath(f"{os.getpid()}").touch()
    time.sleep(600)
    return 0


def complain(task: int) -> int:
    raise InputError(f"task {task} is bad") if task else ZeroDivisionError("ours")


@pytest.fixture
def workers():
    team = ProcessWorkers(2)
    yield team
    team.close()


def test_only_the_task_of_the_dead_is_tried_again(workers, tmp_path):
    tasks = [(tmp_path, number) for number in range(6)]
    answers = list(workers.run(note_and_die_once, tasks))
    assert sorted(answers) == [(n, n * n) for n in range(6)]
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(
        [*(f"{n}_0" for n in range(6)), "2_1"]
    )


@pytest.mark.slow
def test_a_task_that_kills_everybody_is_given_up(workers, tmp_path):
    with pytest.raises(WorkerError, match=r"3 workers died over the same task.*code 3"):
        list(workers.run(note_and_die, [(tmp_path, number) for number in range(3)]))
    assert len(list(tmp_path.glob("1_*"))) == 3


def test_errors_come_back_as_they_are(workers):
    with pytest.raises(InputError, match="task 1 is bad"):
        list(workers.run(complain, [1]))
    with pytest.raises(RuntimeError, match="ZeroDivisionError"):
        list(workers.run(complain, [0]))


@pytest.mark.slow
def test_an_interrupt_ends_the_busy_and_the_next_call_works(workers, tmp_path):
    def interrupt():
        while len(list(tmp_path.iterdir())) < 2:
            time.sleep(0.02)
        os.kill(os.getpid(), signal.SIGINT)

    thread = threading.Thread(target=interrupt)
    thread.start()
    with pytest.raises(KeyboardInterrupt):
        list(workers.run(wait_for_ever, [(tmp_path, number) for number in range(4)]))
    thread.join()
    for path in tmp_path.iterdir():
        with pytest.raises(ProcessLookupError):
            os.kill(int(path.name), 0)
    assert sorted(workers.run(note_and_die_once, [(tmp_path, 0)])) == [(0, 0)]


def test_bad_input_is_one_sentence():
    with pytest.raises(InputError, match="there is no planner 'magic'"):
        Judge("magic", robot="talos")
    with pytest.raises(InputError, match="takes SamplingSettings, not MipSettings"):
        Judge("sampling", MipSettings(), robot="talos")
    with pytest.raises(InputError, match="--processes is 0"):
        Judge("mip", processes=0, robot="talos")
    bench = Judge("mip", workers=Here(), robot="talos")
    with pytest.raises(InputError, match="2 guide paths need as many scene indices"):
        bench.judge(SCENES, PATHS[:2], [0])
    with pytest.raises(InputError, match="guide path 1 is over scene 2; there are 2 scenes"):
        bench.judge(SCENES, PATHS[:2], [0, 2])
