"""The robustness of one equilibrium by definition, with a general solver (HiGHS)."""

import numpy as np
from jaxtyping import Float
from scipy.optimize import linprog

from jaxleas.types import JaxleasError


def robustness_by_linear_program(
    wrenches: Float[np.ndarray, "6 G"], force: Float[np.ndarray, " 3"]
) -> float:
    """Return max b0 with G b = [f; 0], b_i >= b0, torques about the centre of mass [N].

    Where no b balances the force, however large (too few points to span all wrenches), there is
    no equilibrium at any margin and the answer is minus infinity; where squeezing harder always
    helps, it is plus infinity.

    Args:
        wrenches: wrenches of the generators, one column each.
        force: force m (a - g) to balance [N].

    Raises:
        JaxleasError: HiGHS found no answer.
    """
    size = float(np.linalg.norm(force)) or 1.0
    count = wrenches.shape[1]
    # b = b0 + s with s >= 0: the unknowns are s and b0, in units of the force.
    columns = np.concatenate([wrenches, wrenches.sum(axis=1, keepdims=True)], axis=1)
    answer = linprog(
        np.append(np.zeros(count), -1.0),
        A_eq=columns,
        b_eq=np.concatenate([force, np.zeros(3)]) / size,
        bounds=[(0, None)] * count + [(None, None)],
        method="highs",
        options={"primal_feasibility_tolerance": 1e-10, "dual_feasibility_tolerance": 1e-10},
    )
    if answer.status == 2:
        return -np.inf
    if answer.status == 3:
        return np.inf
    if answer.status != 0:
        raise JaxleasError(f"HiGHS could not decide an equilibrium: {answer.message}")
    return float(answer.x[-1]) * size
