"""Linear and mixed-integer programs, and HiGHS to solve them."""

from dataclasses import dataclass, field
from typing import Literal

import highspy
import numpy as np
from jaxtyping import Bool, Float, Int
from scipy import sparse

SolverStatus = Literal["optimal", "infeasible", "time_limit", "failed"]


@dataclass(frozen=True, eq=False)
class Program:
    """min cost . x, low <= x <= high, row_low <= A x <= row_high.

    Attributes:
        cost: linear cost of the variables.
        low: lower bounds of the variables.
        high: upper bounds of the variables.
        A: sparse matrix of the rows.
        row_low: lower bounds of the rows.
        row_high: upper bounds of the rows.
        integer: whether each variable is integer.
    """

    cost: Float[np.ndarray, " n"]
    low: Float[np.ndarray, " n"]
    high: Float[np.ndarray, " n"]
    A: sparse.csr_array
    row_low: Float[np.ndarray, " m"]
    row_high: Float[np.ndarray, " m"]
    integer: Bool[np.ndarray, " n"] | None = None


@dataclass(frozen=True, eq=False)
class Solution:
    """The result from HiGHS.

    Attributes:
        status: "failed" means numerical trouble; "optimal" is within `GAP` for integer programs.
        x: values of the variables; meaningful when optimal.
        duals: duals of the rows.
    """

    status: SolverStatus
    x: Float[np.ndarray, " n"]
    duals: Float[np.ndarray, " m"] = field(default_factory=lambda: np.zeros(0))


TOLERANCE = 1e-9
"""Feasibility tolerance on rows and bounds of linear programs [m]."""
GAP = 0.01
"""An integer solution is accepted if its cost is within this fraction of the best possible."""


def solve(program: Program, time_limit: float = np.inf) -> Solution:
    """Solve a program on one thread.

    Args:
        program: program to solve.
        time_limit: time limit [s]; an integer solution found by then is returned, though not proved
            best.
    """
    if time_limit <= 0.0:
        return Solution("time_limit", np.zeros(0))
    highs = highspy.Highs()
    highs.silent()
    highs.setOptionValue("threads", 1)
    highs.setOptionValue("time_limit", float(min(time_limit, 1e9)))
    is_mip = program.integer is not None and bool(program.integer.any())
    if is_mip:  # the choices are easy to find: these two cost more than they gain
        highs.setOptionValue("mip_heuristic_run_feasibility_jump", False)
        highs.setOptionValue("mip_detect_symmetry", False)
        highs.setOptionValue("mip_rel_gap", GAP)
    else:
        highs.setOptionValue("presolve", "off")  # takes longer than these programs
        highs.setOptionValue("primal_feasibility_tolerance", TOLERANCE)
        highs.setOptionValue("dual_feasibility_tolerance", 1e-8)
    _pass(program, highs)
    highs.run()
    status = _STATUSES.get(highs.getModelStatus(), "failed")
    solution = highs.getSolution()
    if is_mip and status == "time_limit" and highs.getInfo().primal_solution_status == _FEASIBLE:
        status = "optimal"
    return Solution(status, np.array(solution.col_value), np.array(solution.row_dual))


_FEASIBLE = int(highspy.SolutionStatus.kSolutionStatusFeasible)
_STATUSES: dict[highspy.HighsModelStatus, SolverStatus] = {
    highspy.HighsModelStatus.kOptimal: "optimal",
    highspy.HighsModelStatus.kInfeasible: "infeasible",
    highspy.HighsModelStatus.kUnboundedOrInfeasible: "infeasible",
    highspy.HighsModelStatus.kTimeLimit: "time_limit",
}


def _pass(program: Program, highs: highspy.Highs) -> None:
    """Pass whole arrays; the attributes of a HighsLp would copy them number by number."""
    A = program.A
    integer = program.integer
    kinds = np.zeros(len(program.cost), np.int32) if integer is None else integer.astype(np.int32)
    highs.passModel(
        len(program.cost), len(program.row_low), A.nnz,
        int(highspy.MatrixFormat.kRowwise), int(highspy.ObjSense.kMinimize), 0.0,
        program.cost, program.low, program.high, program.row_low, program.row_high,
        A.indptr.astype(np.int32), A.indices.astype(np.int32), A.data.astype(np.float64), kinds,
    )  # fmt: skip


@dataclass
class Rows:
    """Collects rows of a sparse matrix, dense block by dense block."""

    columns: int
    row: list[Int[np.ndarray, " e"]] = field(default_factory=list)
    column: list[Int[np.ndarray, " e"]] = field(default_factory=list)
    value: list[Float[np.ndarray, " e"]] = field(default_factory=list)
    low: list[Float[np.ndarray, " r"]] = field(default_factory=list)
    high: list[Float[np.ndarray, " r"]] = field(default_factory=list)
    count: int = 0

    def add(
        self,
        blocks: list[tuple[Int[np.ndarray, " c"], Float[np.ndarray, "r c"]]],
        high: Float[np.ndarray, " r"],
        low: Float[np.ndarray, " r"] | None = None,
    ) -> None:
        """Append rows low <= sum_i block_i x[columns_i] <= high; low is -infinity if not given."""
        size = len(high)
        here = np.arange(self.count, self.count + size)
        for columns, block in blocks:
            self.row.append(np.repeat(here, len(columns)))
            self.column.append(np.tile(columns, size))
            self.value.append(np.ascontiguousarray(block).reshape(-1))
        self.high.append(high)
        self.low.append(np.full(size, -np.inf) if low is None else low)
        self.count += size

    def matrix(self) -> sparse.csr_array:
        """Return all rows."""
        if not self.row:
            return sparse.csr_array((0, self.columns))
        entries = np.concatenate(self.value)
        where = (np.concatenate(self.row), np.concatenate(self.column))
        made = sparse.csr_array((entries, where), shape=(self.count, self.columns))
        made.eliminate_zeros()
        return made

    def bounds(self) -> tuple[Float[np.ndarray, " m"], Float[np.ndarray, " m"]]:
        """Return the lower and the upper bounds of all rows."""
        if not self.low:
            return np.zeros(0), np.zeros(0)
        return np.concatenate(self.low), np.concatenate(self.high)
