# SPDX-License-Identifier: Apache-2.0
"""What is written in Python and used by the engine: bases of terms and solvers."""


class Term:
    """One cost or constraint over a batch of trajectories, written in Python.

    Derive from it, set `name`, and write `value`. With `gradient` (a cost) or `jacobian` (a
    constraint) back ends with derivatives can use it. A term is a constraint if it has a method
    `rows`: feasible where all its values are >= 0.

    Methods get `t`, a `Trajectories`, and must depend on nothing else that changes during a solve.
    They are called by one thread at a time.
    """

    name = None
    """str: letters, digits and "_-"."""
    unit = "-"
    """Of the value."""
    smoothness = "smooth"
    """"smooth", "C1", "C0" or "discontinuous", in states and inputs."""
    lower_bound = None
    """Of a cost: a number that it never is below. Back ends for least squares need it."""

    rows = None
    """Of a constraint: rows(N), how many values it has over N stages."""

    def value(self, t):
        """A cost: (B,). A constraint: (B, rows). A value that is not finite: cannot be evaluated."""
        raise NotImplementedError(f"{type(self).__name__}.value")

    gradient = None
    """Of a cost: gradient(t) of a batch of one, a dict of d value / d ...

    "poses": (N+1, 4), by x, y, z, yaw; "states": (N+1, nx); "inputs": (N, nu). What is missing is
    0, what is given twice adds up.
    """

    jacobian = None
    """Of a constraint: jacobian(t) of a batch of one, the same with the rows in front:

    "poses": (rows, N+1, 4), "states": (rows, N+1, nx), "inputs": (rows, N, nu).
    """


class Solver:
    """A back end written in Python.

    Derive from it, set `name` and `description`, and write `run`. Options, bounds, the deadline,
    the best point and the counters are kept for it: see `Evaluator`.
    """

    name = None
    """str: letters, digits and "_-.:"."""
    description = None
    """One sentence."""
    options = {}
    """NAME: (DEFAULT, SENTENCE), beside those that all back ends take."""
    needs_gradient = True
    """Whether it asks for derivatives: problems without are refused."""
    takes_constraints = True
    """Whether it minds constraints: otherwise problems with some are refused."""

    def run(self, evaluator, options, warm_start):
        """Solves from `evaluator.start` and returns what `evaluator.finish()` gives.

        options: dict with a value for every option. May let `Stopped` pass, which the evaluator
        raises once the solve must end. Called by one thread at a time.
        """
        raise NotImplementedError(f"{type(self).__name__}.run")
