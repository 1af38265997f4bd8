"""Planning for robots that explore by sight: problems, solvers, planners and missions.

Arrays are numpy's. Units are SI, angles rad, frames as docs/reference/models.md has them. Bad input
is a ValueError whose lines say what, where (file:line or key) and what was expected.
"""

from prospect._core import (
    CallbackError,
    Evaluation,
    Evaluator,
    Explanation,
    MotionModel,
    Problem,
    Quality,
    Registries,
    Result,
    SolveError,
    StopReason,
    Stopped,
    TermValue,
    Trajectories,
    WarmStart,
    __version__,
    load_problem,
    motion_model,
    solve,
)
from prospect.extensions import Solver, Term
