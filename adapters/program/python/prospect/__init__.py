# SPDX-License-Identifier: Apache-2.0
"""Planning for robots that explore by sight: problems, solvers, planners and missions.

Arrays are numpy's. Units are SI, angles rad, frames as docs/reference/models.md has them. Bad input
is a ValueError whose lines say what, where (file:line or key) and what was expected.
"""

from prospect._core import (
    Belief,
    CallbackError,
    Configuration,
    Evaluation,
    Evaluator,
    Explanation,
    Landmarks,
    Maps,
    MotionModel,
    Plan,
    Planner,
    PlanningContext,
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

# Loaded when they are asked for: numpy and the simulator take as long as all else.
_LATER = {
    "Simulation": "prospect._program",
    "main": "prospect.program",
    "Bench": "prospect.results",
    "Columns": "prospect.results",
    "Log": "prospect.results",
    "Run": "prospect.results",
    "load_bench": "prospect.results",
    "load_log": "prospect.results",
    "load_run": "prospect.results",
    "load_study": "prospect.results",
    "load_table": "prospect.results",
}

__all__ = sorted([name for name in globals() if not name.startswith("_")] + list(_LATER))


def __getattr__(name):
    if name in _LATER:
        import importlib

        return getattr(importlib.import_module(_LATER[name]), name)
    raise AttributeError(f"module 'prospect' has no attribute '{name}'")


def __dir__():
    return __all__
