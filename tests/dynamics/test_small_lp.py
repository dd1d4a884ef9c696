import numpy as np
from scipy.optimize import linprog

from jaxleas.dynamics.small_lp import maximise


def random_problems(count: int, rows: int, width: int, seed: int):
    rng = np.random.default_rng(seed)
    A = rng.normal(size=(count, rows, width))
    b = rng.uniform(0.0, 1.0, size=(count, rows))
    return rng.normal(size=(count, width)), A, b


def test_agrees_with_a_general_solver():
    objective, A, b = random_problems(60, 12, 4, seed=0)
    answer = maximise(objective, A, b)
    solved = 0
    for c, rows, bounds, y, good in zip(
        objective, A, b, answer.variables, answer.solved, strict=True
    ):
        expected = linprog(-c, A_ub=rows, b_ub=bounds, bounds=[(None, None)] * len(c))
        assert good == (expected.status == 0)  # 3: unbounded
        if good:
            solved += 1
            np.testing.assert_allclose(c @ y, -expected.fun, atol=1e-6)
            assert (rows @ y <= bounds + 1e-7).all()
    assert 20 < solved < 60


def test_active_rows_are_those_the_answer_lies_on():
    objective, A, b = random_problems(30, 20, 5, seed=1)
    answer = maximise(objective, A, b)
    for index in np.flatnonzero(answer.solved):
        rows = answer.active[index]
        assert (rows >= 0).all()
        exact = np.linalg.solve(A[index, rows], b[index, rows])
        np.testing.assert_allclose(answer.variables[index], exact, atol=1e-5)


def test_ties_do_not_cycle():
    # A cube with every face given eight times, from a corner that all of them touch.
    faces = np.concatenate([np.eye(3), -np.eye(3)])
    rows = np.tile(faces, (8, 1))[None]
    bounds = np.tile([1.0, 1.0, 1.0, 0.0, 0.0, 0.0], 8)[None]
    answer = maximise(np.array([[1.0, 2.0, 3.0]]), rows, bounds)
    assert answer.solved.all()
    np.testing.assert_allclose(answer.variables, [[1.0, 1.0, 1.0]], atol=1e-6)


def test_unbounded_is_not_called_solved():
    answer = maximise(np.array([[1.0, 0.0]]), np.array([[[-1.0, 0.0]]]), np.array([[1.0]]))
    assert not answer.solved[0]
