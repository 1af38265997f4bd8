# SPDX-License-Identifier: Apache-2.0
"""What tests/adapters/evaluate_casadi.py needs of CasADi, where CasADi is not: SX as a graph that is evaluated with
its derivatives, forward. It knows nothing else."""

import math


class SX:
    """A scalar: an operation on scalars, or a number."""

    def __init__(self, value, columns=None):
        if columns is not None:
            assert (value, columns) == (0, 1)
            self.operation, self.operands = "empty", ()
        elif isinstance(value, SX):
            self.operation, self.operands = value.operation, value.operands
        else:
            self.operation, self.operands = "number", (float(value),)

    @staticmethod
    def sym(name, count):
        return [_make("variable", i) for i in range(count)]

    def __add__(self, other):
        return _make("+", self, other)

    def __radd__(self, other):
        return _make("+", other, self)

    def __sub__(self, other):
        return _make("-", self, other)

    def __rsub__(self, other):
        return _make("-", other, self)

    def __mul__(self, other):
        return _make("*", self, other)

    def __rmul__(self, other):
        return _make("*", other, self)

    def __truediv__(self, other):
        return _make("/", self, other)

    def __rtruediv__(self, other):
        return _make("/", other, self)

    def __pow__(self, other):
        return _make("**", self, other)

    def __rpow__(self, other):
        return _make("**", other, self)

    def __neg__(self):
        return _make("-", 0.0, self)

    def __lt__(self, other):
        return _make("<", self, other)

    def __le__(self, other):
        return _make("<=", self, other)

    def __gt__(self, other):
        return _make("<", other, self)

    def __ge__(self, other):
        return _make("<=", other, self)

    def __eq__(self, other):
        return _make("==", self, other)

    __hash__ = object.__hash__


def _make(operation, *operands):
    made = SX(0.0)
    made.operation = operation
    made.operands = tuple(o if isinstance(o, (SX, int)) and not isinstance(o, bool) else SX(o) for o in operands)
    if operation != "variable":
        made.operands = tuple(o if isinstance(o, SX) else SX(o) for o in made.operands)
    return made


# Value and slope of functions of one argument.
_FUNCTIONS = {
    "sin": (math.sin, lambda a, v: math.cos(a)),
    "cos": (math.cos, lambda a, v: -math.sin(a)),
    "tan": (math.tan, lambda a, v: 1 + v * v),
    "exp": (math.exp, lambda a, v: v),
    "log": (math.log, lambda a, v: 1 / a),
    "sqrt": (math.sqrt, lambda a, v: 1 / (2 * v)),
    "fabs": (abs, lambda a, v: math.copysign(1.0, a)),
    "tanh": (math.tanh, lambda a, v: 1 - v * v),
    "sinh": (math.sinh, lambda a, v: math.cosh(a)),
    "cosh": (math.cosh, lambda a, v: math.sinh(a)),
    "asin": (math.asin, lambda a, v: 1 / math.sqrt(1 - a * a)),
    "acos": (math.acos, lambda a, v: -1 / math.sqrt(1 - a * a)),
    "atan": (math.atan, lambda a, v: 1 / (1 + a * a)),
    "asinh": (math.asinh, lambda a, v: 1 / math.sqrt(a * a + 1)),
    "acosh": (math.acosh, lambda a, v: 1 / math.sqrt(a * a - 1)),
    "atanh": (math.atanh, lambda a, v: 1 / (1 - a * a)),
    "log10": (math.log10, lambda a, v: 1 / (a * math.log(10))),
    "logic_not": (lambda a: float(a == 0), lambda a, v: 0.0),
}
# Value and slopes of those of two.
_PAIRS = {
    "+": (lambda a, b: a + b, lambda a, b, v: (1.0, 1.0)),
    "-": (lambda a, b: a - b, lambda a, b, v: (1.0, -1.0)),
    "*": (lambda a, b: a * b, lambda a, b, v: (b, a)),
    "/": (lambda a, b: a / b, lambda a, b, v: (1 / b, -a / (b * b))),
    "**": (lambda a, b: a**b, lambda a, b, v: (b * a ** (b - 1), v * math.log(a) if a > 0 else 0.0)),
    "<": (lambda a, b: float(a < b), lambda a, b, v: (0.0, 0.0)),
    "<=": (lambda a, b: float(a <= b), lambda a, b, v: (0.0, 0.0)),
    "==": (lambda a, b: float(a == b), lambda a, b, v: (0.0, 0.0)),
    "fmin": (min, lambda a, b, v: (float(a <= b), float(a > b))),
    "fmax": (max, lambda a, b, v: (float(a >= b), float(a < b))),
    "atan2": (math.atan2, lambda a, b, v: (b / (a * a + b * b), -a / (a * a + b * b))),
    "logic_and": (lambda a, b: float(a != 0 and b != 0), lambda a, b, v: (0.0, 0.0)),
    "logic_or": (lambda a, b: float(a != 0 or b != 0), lambda a, b, v: (0.0, 0.0)),
}


def __getattr__(name):
    if name in _FUNCTIONS or name in _PAIRS:
        return lambda *operands: _make(name, *operands)
    raise AttributeError(name)


def if_else(condition, then, otherwise):
    return _make("if_else", condition, then, otherwise)


def vertcat(*scalars):
    return [s if isinstance(s, SX) else SX(s) for s in scalars]


def evaluated(scalars, x):
    """[(value, {variable: derivative})] of scalars."""
    known = {}

    def of(node):
        pending = [node]
        while pending:
            top = pending[-1]
            if id(top) in known:
                pending.pop()
                continue
            if top.operation in ("number", "variable"):
                number = top.operation == "number"
                known[id(top)] = (top.operands[0], {}) if number else (x[top.operands[0]], {top.operands[0]: 1.0})
                continue
            missing = [o for o in top.operands if id(o) not in known]
            if missing:
                pending += missing
                continue
            operands = [known[id(o)] for o in top.operands]
            if top.operation == "if_else":
                known[id(top)] = operands[1] if operands[0][0] != 0 else operands[2]
                continue
            values = [value for value, _ in operands]
            if top.operation in _FUNCTIONS:
                function, slope = _FUNCTIONS[top.operation]
                value = function(*values)
                slopes = (slope(*values, value),)
            else:
                function, slope = _PAIRS[top.operation]
                value = function(*values)
                slopes = slope(*values, value)
            by = {}
            for (_, derivatives), factor in zip(operands, slopes):
                for variable, derivative in derivatives.items():
                    by[variable] = by.get(variable, 0.0) + factor * derivative
            known[id(top)] = (value, by)
        return known[id(node)]

    return [of(s) for s in scalars]
