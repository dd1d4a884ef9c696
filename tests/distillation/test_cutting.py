"""Episodes cut where the planner failed, and laid end to end: against slow twins."""

from dataclasses import replace

import numpy as np
import pytest

from jaxleas.distillation.collect import Walks
from jaxleas.distillation.cutting import Stream, cut, kept_steps, to_experience
from jaxleas.distillation.episodes import Episodes
from jaxleas.labels import Verdict
from jaxleas.types import RootMotion

TIME, SIZE, COST = 12, 3, 60.6
VERDICT = Verdict(0, True, True, 0, 1, 1.0, 0, None, None, None, None, None, None, "", 0.1)


def episodes(steps, terminated):
    """Episodes whose every number says whose it is and when: 100 robot + time."""
    count = len(steps)
    number = 100.0 * np.arange(count)[:, None] + np.arange(TIME)[None]
    last = np.arange(TIME)[None] == np.array(steps)[:, None] - 1
    motion = RootMotion(*(np.zeros((count, TIME + 1, 3)) for _ in range(2)), np.zeros(1))
    walks = Walks(motion, np.ones((count, TIME + 1), bool), np.zeros(count, np.int64))
    return Episodes(
        walks=walks,
        observation=number[..., None] * np.ones(SIZE),
        raw_action=number[..., None] * np.ones(4),
        location=-number[..., None] * np.ones(4),
        deviation=number[..., None] * np.ones(4),
        reward=number.astype(np.float32),
        terminated=last & np.array(terminated)[:, None],
        reached=np.zeros((count, TIME), bool),
        steps=np.array(steps),
        failure_cost=COST,
        update=7,
    )


def verdict(success=True, last_index=0, decided=True):
    return replace(VERDICT, success=success, last_index=last_index, decided=decided)


CASES = [  # steps, met an invalid configuration, verdict -> steps kept, terminated, charged now
    (12, False, verdict(), 12, False, False),
    (8, True, verdict(), 8, True, False),
    (12, False, verdict(False, 5), 6, True, True),
    (8, True, verdict(False, 5), 6, True, True),
    (6, True, verdict(False, 5), 6, True, False),  # the same step, by the conditions already
    (12, False, verdict(False, 0), 1, True, True),
    (12, False, verdict(False, -1), 0, False, False),
    (12, False, verdict(False, 5, decided=False), 0, False, False),
]


def test_tails_are_cut_and_charged_once():
    whole = episodes([each[0] for each in CASES], [each[1] for each in CASES])
    verdicts = [each[2] for each in CASES]
    np.testing.assert_array_equal(kept_steps(whole, verdicts), [each[3] for each in CASES])
    steps = cut(whole, verdicts)
    row = 0
    for robot, (_, _, _, kept, terminated, charged) in enumerate(CASES):
        for time in range(kept):
            last = time == kept - 1
            assert np.all(steps["location"][row] == -(100.0 * robot + time))
            assert steps["terminated"][row] == (last and terminated)
            assert steps["truncated"][row] == (last and not terminated)
            expected = 100.0 * robot + time - COST * (last and charged)
            assert steps["reward"][row] == pytest.approx(expected, abs=1e-4)
            row += 1
    assert row == len(steps["reward"])
    assert np.sum(steps["by_planner"]) == 4
    assert set(steps["update"].tolist()) == {7}


def test_nothing_accepted_is_nothing_to_learn_from():
    stream = Stream(2, 3)
    stream.add(cut(episodes([4, 4], [False, False]), [verdict(False, -1)] * 2))
    assert len(stream) == 0
    assert stream.batch() is None


def test_batches_are_the_stream_row_by_row_and_nothing_is_lost_or_doubled():
    rows, unroll = 4, 5
    stream, taken = Stream(rows, unroll), []
    for _ in range(5):
        stream.add(cut(episodes([12, 7], [False, True]), [verdict()] * 2))
        while (batch := stream.batch()) is not None:
            experience, after = to_experience(batch, rows, unroll)
            assert experience.reward.shape == (unroll, rows)
            walked = np.asarray(experience.distributions[0].location[..., 0])
            taken += [walked[t, r] for r in range(rows) for t in range(unroll)]
            for r in range(rows):
                follows = batch["observation"][(r + 1) * unroll]
                np.testing.assert_array_equal(after[r], follows)
            ended = batch["terminated"][: rows * unroll].reshape(rows, unroll)
            np.testing.assert_array_equal(experience.terminated, ended.T)
    everything = [-(100.0 * robot + t) for robot, n in ((0, 12), (1, 7)) for t in range(n)] * 5
    assert len(stream) + len(taken) == len(everything)
    assert len(stream) >= 1  # the step after the last row waits for its own batch
    np.testing.assert_allclose(taken, everything[: len(taken)])
