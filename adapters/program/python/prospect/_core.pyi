# SPDX-License-Identifier: Apache-2.0
# What a type checker knows of the compiled module. A test compares it with the module.
import os
from enum import Enum
from typing import Any, Callable, Iterable, Optional, Union

import numpy as np
from numpy.typing import ArrayLike

from prospect.extensions import Solver, Term

_Path = Union[str, bytes, os.PathLike[str]]
_Array = np.ndarray[Any, np.dtype[np.float64]]
_Cells = np.ndarray[Any, np.dtype[np.uint8]]
_Extent = tuple[float, float, float, float]

__version__: str

class CallbackError(RuntimeError): ...

class SolveError(RuntimeError):
    result: Result

class Stopped(RuntimeError): ...

class StopReason(Enum):
    CONVERGED = ...
    DEADLINE = ...
    ITERATION_LIMIT = ...
    CANCELLED = ...
    NUMERICAL_TROUBLE = ...
    ERROR = ...
    INFEASIBLE = ...
    UNBOUNDED = ...

class Quality(Enum):
    FEASIBLE_OPTIMUM = ...
    FEASIBLE = ...
    INFEASIBLE = ...
    NONE = ...

class Trajectories:
    @property
    def states(self) -> _Array: ...  # (B, N+1, nx)
    @property
    def inputs(self) -> _Array: ...  # (B, N, nu)
    @property
    def poses(self) -> _Array: ...  # (B, N+1, 4)
    @property
    def u_previous(self) -> _Array: ...  # (nu,)
    @property
    def times(self) -> _Array: ...  # (N+1,)
    @property
    def B(self) -> int: ...
    @property
    def N(self) -> int: ...
    @property
    def nx(self) -> int: ...
    @property
    def nu(self) -> int: ...
    @property
    def dt(self) -> float: ...

class Evaluation:
    @property
    def cost(self) -> _Array: ...  # (B,)
    @property
    def cost_error(self) -> _Array: ...  # (B,)
    @property
    def valid(self) -> np.ndarray[Any, np.dtype[np.bool_]]: ...  # (B,)
    @property
    def constraints(self) -> _Array: ...  # (B, m)
    @property
    def terms(self) -> _Array: ...  # (B, T)
    @property
    def gradient(self) -> _Array: ...  # (n,)
    @property
    def jacobian(self) -> _Array: ...  # (m, n)
    @property
    def residuals(self) -> _Array: ...  # (R,)
    @property
    def residual_jacobian(self) -> _Array: ...  # (R, n)
    @property
    def residual_offset(self) -> float: ...

class TermValue:
    @property
    def name(self) -> str: ...
    @property
    def unit(self) -> str: ...
    @property
    def raw(self) -> float: ...
    @property
    def weighted(self) -> float: ...
    @property
    def constraint(self) -> bool: ...

class Explanation:
    @property
    def cost(self) -> float: ...
    @property
    def violation(self) -> float: ...
    @property
    def terms(self) -> list[TermValue]: ...

class MotionModel:
    @property
    def name(self) -> str: ...
    @property
    def nx(self) -> int: ...
    @property
    def nu(self) -> int: ...
    @property
    def lower(self) -> _Array: ...  # (nu,)
    @property
    def upper(self) -> _Array: ...  # (nu,)

def motion_model(name: str, **limits: float) -> MotionModel: ...

class Problem:
    def __init__(
        self,
        model: MotionModel,
        x0: ArrayLike,
        terms: Iterable[Union[Term, tuple[Term, float]]],
        *,
        u_previous: Optional[ArrayLike] = None,
        N: int = 20,
        dt: float = 0.25,
        M: int = 10,
        start: Optional[ArrayLike] = None,
    ) -> None: ...
    @staticmethod
    def from_functions(
        lower: ArrayLike,
        upper: ArrayLike,
        cost: Callable[[_Array], float],
        gradient: Optional[Callable[[_Array], ArrayLike]] = None,
        *,
        rows: int = 0,
        constraints: Optional[Callable[[_Array], ArrayLike]] = None,
        jacobian: Optional[Callable[[_Array], ArrayLike]] = None,
        start: Optional[ArrayLike] = None,
        name: str = "function",
    ) -> Problem: ...
    @property
    def n(self) -> int: ...
    @property
    def m(self) -> int: ...
    @property
    def N(self) -> int: ...
    @property
    def M(self) -> int: ...
    @property
    def dt(self) -> float: ...
    @property
    def lower(self) -> _Array: ...  # (n,)
    @property
    def upper(self) -> _Array: ...  # (n,)
    @property
    def x0(self) -> _Array: ...  # (nx,)
    @property
    def terms(self) -> list[tuple[str, float]]: ...
    @property
    def has_gradient(self) -> bool: ...
    @property
    def jacobian_pattern(self) -> np.ndarray[Any, np.dtype[np.bool_]]: ...  # (m, n)
    @property
    def start(self) -> WarmStart: ...
    @property
    def origin(self) -> Optional[dict[str, Any]]: ...
    def evaluate(self, z: ArrayLike, what: str = "value") -> Evaluation: ...
    def cost(self, z: ArrayLike) -> Any: ...  # float at (n,), (B,) at (B, n)
    def gradient(self, z: ArrayLike) -> _Array: ...  # (n,)
    def constraints(self, z: ArrayLike) -> _Array: ...  # (m,) or (B, m)
    def jacobian(self, z: ArrayLike) -> _Array: ...  # (m, n)
    def residuals(self, z: ArrayLike) -> Evaluation: ...
    def explain(self, z: ArrayLike) -> Explanation: ...
    def rollout(self, z: ArrayLike) -> Trajectories: ...
    def knots_from_inputs(self, inputs: ArrayLike) -> _Array: ...  # (n,)
    def save(self, path: _Path) -> None: ...

def load_problem(path: _Path, registries: Optional[Registries] = None) -> Problem: ...

class WarmStart:
    x: _Array  # (n,)
    multipliers: _Array  # (m,)
    z_lower: _Array  # (n,)
    z_upper: _Array  # (n,)
    seeds: _Array  # (S, n)
    mu: float
    time: float
    def __init__(self) -> None: ...

class Result:
    @property
    def stop(self) -> StopReason: ...
    @property
    def quality(self) -> Quality: ...
    @property
    def x(self) -> _Array: ...  # (n,)
    @property
    def cost(self) -> float: ...
    @property
    def violation(self) -> float: ...
    @property
    def explanation(self) -> Explanation: ...
    @property
    def next(self) -> WarmStart: ...
    @property
    def cost_evaluations(self) -> int: ...
    @property
    def gradient_evaluations(self) -> int: ...
    @property
    def iterations(self) -> int: ...
    @property
    def seconds(self) -> float: ...
    @property
    def detail(self) -> str: ...
    @property
    def trace(self) -> _Array: ...  # (K, 4)

class Evaluator:
    @property
    def n(self) -> int: ...
    @property
    def m(self) -> int: ...
    @property
    def lower(self) -> _Array: ...  # (n,)
    @property
    def upper(self) -> _Array: ...  # (n,)
    @property
    def start(self) -> _Array: ...  # (n,)
    @property
    def evaluations_left(self) -> int: ...
    @property
    def incumbent(self) -> Optional[_Array]: ...  # (n,)
    @property
    def incumbent_cost(self) -> float: ...
    def cost(self, x: ArrayLike) -> float: ...
    def cost_and_gradient(self, x: ArrayLike) -> tuple[float, _Array]: ...
    def constraints(self, x: ArrayLike) -> _Array: ...  # (m,)
    def jacobian(self, x: ArrayLike) -> _Array: ...  # (m, n)
    def evaluate_batch(self, X: ArrayLike) -> tuple[_Array, _Array]: ...  # (B,), (B,)
    def should_stop(self) -> bool: ...
    def count_iteration(self) -> None: ...
    def finish(
        self,
        stop: StopReason = StopReason.CONVERGED,
        optimum: bool = False,
        detail: str = "",
        next: Optional[WarmStart] = None,
    ) -> Result: ...

class Registries:
    def __init__(self) -> None: ...
    def add_solver(self, solver: Solver) -> None: ...
    def add_term(
        self,
        name: str,
        make: Callable[[dict[str, float], PlanningContext], Term],
        *,
        options: dict[str, tuple[float, float, float, str, str]] = {},
        description: str = "",
        version: int = 1,
    ) -> None: ...
    def add_problem(
        self,
        set: str,
        name: str,
        problem: Problem,
        *,
        best_known: Optional[float] = None,
        description: str = "",
    ) -> None: ...
    def load_plugin(self, path: _Path) -> str: ...
    def solvers(self) -> list[dict[str, Any]]: ...
    def terms(self) -> list[dict[str, Any]]: ...
    def sets(self) -> list[str]: ...

def solve(
    problem: Problem,
    solver: Union[str, Solver] = "nlopt",
    *,
    start: Union[None, WarmStart, ArrayLike] = None,
    deadline: Optional[float] = None,
    registries: Optional[Registries] = None,
    cancelled: Optional[Callable[[], bool]] = None,
    **options: Union[int, float, str],
) -> Result: ...

class Configuration:
    def __init__(
        self,
        path: _Path = "",
        settings: dict[str, Any] = {},
        registries: Optional[Registries] = None,
    ) -> None: ...
    @property
    def values(self) -> dict[str, str]: ...
    @property
    def yaml(self) -> str: ...
    @property
    def solver(self) -> str: ...
    @property
    def motion_model(self) -> MotionModel: ...

class PlanningContext:
    @property
    def x0(self) -> _Array: ...  # (nx,)
    @property
    def u_previous(self) -> _Array: ...  # (nu,)
    @property
    def N(self) -> int: ...
    @property
    def M(self) -> int: ...
    @property
    def dt(self) -> float: ...
    @property
    def ground(self) -> _Cells: ...  # (ny, nx)
    @property
    def extent(self) -> _Extent: ...
    @property
    def landmarks(self) -> _Array: ...  # (L, 3)
    @property
    def targets(self) -> _Array: ...  # (T, 4)

class Maps:
    def __init__(
        self, voxels: ArrayLike, resolution: float, origin: ArrayLike, configuration: Configuration
    ) -> None: ...
    @property
    def ground(self) -> _Cells: ...  # (ny, nx)
    @property
    def extent(self) -> _Extent: ...

class Landmarks:
    def __init__(
        self,
        position: ArrayLike,
        *,
        covariance: Optional[ArrayLike] = None,
        direction: Optional[ArrayLike] = None,
        range: Optional[ArrayLike] = None,
        survival: Optional[ArrayLike] = None,
        feature_density: float = 5.0,
    ) -> None: ...
    @property
    def position(self) -> _Array: ...  # (L, 3)
    def __len__(self) -> int: ...

class Belief:
    def __init__(
        self,
        maps: Maps,
        pose: ArrayLike,
        *,
        stamp: float,
        covariance: Optional[ArrayLike] = None,
        velocity: ArrayLike = ...,
        command: Optional[ArrayLike] = None,
        landmarks: Optional[Landmarks] = None,
        localization: str = "ok",
        tracked_features: int = 0,
        map_frame: Optional[ArrayLike] = None,
        movers: Optional[ArrayLike] = None,
    ) -> None: ...
    @property
    def stamp(self) -> float: ...
    @property
    def pose(self) -> _Array: ...  # (4,)
    @property
    def covariance(self) -> _Array: ...  # (4, 4)
    @property
    def velocity(self) -> _Array: ...  # (4,)
    @property
    def command(self) -> Optional[_Array]: ...  # (4,)
    @property
    def localization(self) -> str: ...
    @property
    def tracked_features(self) -> int: ...
    @property
    def map_frame(self) -> Optional[_Array]: ...  # (3,)
    @property
    def ground(self) -> _Cells: ...  # (ny, nx)
    @property
    def extent(self) -> _Extent: ...
    @property
    def voxels(self) -> _Cells: ...  # (ny, nx, nz)
    @property
    def voxels_origin(self) -> tuple[float, float, float]: ...
    @property
    def resolution(self) -> float: ...
    @property
    def landmarks(self) -> _Array: ...  # (L, 3)

class Plan:
    @property
    def kind(self) -> str: ...
    @property
    def fault(self) -> str: ...
    @property
    def stamp(self) -> float: ...
    @property
    def dt(self) -> float: ...
    @property
    def states(self) -> _Array: ...  # (N+1, nx)
    @property
    def inputs(self) -> _Array: ...  # (N, nu)
    @property
    def commands(self) -> _Array: ...  # (N, 4)
    @property
    def tail(self) -> _Array: ...  # (K, 4)
    @property
    def visible(self) -> _Array: ...  # (N+1,)
    @property
    def committed(self) -> int: ...
    @property
    def certified(self) -> bool: ...
    @property
    def certificate(self) -> str: ...
    @property
    def seed(self) -> str: ...
    @property
    def solver(self) -> str: ...
    @property
    def stop(self) -> StopReason: ...
    @property
    def quality(self) -> Quality: ...
    @property
    def explanation(self) -> Explanation: ...
    @property
    def mode(self) -> str: ...
    @property
    def cause(self) -> str: ...
    @property
    def why(self) -> str: ...
    @property
    def detail(self) -> str: ...
    @property
    def times_ms(self) -> dict[str, float]: ...
    @property
    def candidates(self) -> list[dict[str, Any]]: ...
    def command_at(self, t: float) -> _Array: ...  # (4,)

class Planner:
    def __init__(
        self,
        configuration: Optional[Configuration] = None,
        solver: Union[None, str, Solver] = None,
        registries: Optional[Registries] = None,
    ) -> None: ...
    def plan(self, belief: Belief, deadline: Optional[float] = None) -> Plan: ...
    def set_task(self, task: str, goal: Optional[ArrayLike] = None) -> None: ...
    def check(
        self, plan: Plan, stage: int, previous: ArrayLike, newest: Belief, now: float
    ) -> dict[str, Any]: ...
    def problem(self) -> Optional[Problem]: ...
    @property
    def target(self) -> Optional[_Array]: ...  # (2,)
    @property
    def cost_to_go(self) -> Optional[tuple[_Array, _Extent]]: ...  # (ny, nx)
