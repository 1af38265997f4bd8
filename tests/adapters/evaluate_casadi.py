# SPDX-License-Identifier: Apache-2.0
"""evaluate_casadi.py FILE.py < POINTS: what a file of `prospect export --to casadi` builds, at points.
evaluate_casadi.py FILE.so NAME < POINTS: the same of the functions of a shared library (CasADi itself only).

Prints a line each of x0, lbx, ubx, lbg, ubg; then for each point f, g, gradient, Jacobian by rows."""

import runpy
import sys

import casadi


def numbers(values):
    print(*(repr(float(v)) for v in values))


points = [[float(word) for word in line.split()] for line in sys.stdin]
if len(sys.argv) == 3:
    functions = casadi.external(sys.argv[2], sys.argv[1])
    for data in casadi.external(sys.argv[2] + "_problem", sys.argv[1]).call([]):
        numbers(data.full().ravel())
    x, p = casadi.MX.sym("x", functions.size1_in(0)), casadi.MX(0, 1)
    f, g = functions(x, p)
else:
    made = runpy.run_path(sys.argv[1])
    for name in ("x0", "lbx", "ubx", "lbg", "ubg"):
        numbers(made[name])
    assert set(made["nlp"]) == {"x", "f", "g"}
    x, f, g = made["x"], made["f"], made["g"]
if hasattr(casadi, "evaluated"):  # the stand-in
    rows = [] if isinstance(g, casadi.SX) else g
    for point in points:
        (value, gradient), *others = casadi.evaluated([f, *rows], point)
        numbers([value])
        numbers(v for v, _ in others)
        numbers(gradient.get(i, 0.0) for i in range(len(x)))
        numbers(by.get(i, 0.0) for _, by in others for i in range(len(x)))
else:
    F = casadi.Function("F", [x], [f, g, casadi.jacobian(f, x), casadi.jacobian(g, x)])
    for point in points:
        for value in F(point):
            numbers(casadi.DM(value).full().ravel())
