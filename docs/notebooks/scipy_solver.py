# SPDX-License-Identifier: Apache-2.0
"""SciPy's SLSQP and trust-constr as back ends: python3 -m prospect bench --plugin scipy_solver.py"""

import numpy as np
import prospect
import scipy.optimize


class SciPy(prospect.Solver):
    options = {"ftol": (1e-6, "change of cost that counts as converged, above 0 [-]")}

    def __init__(self, method):
        self.method = method
        self.name = "scipy:" + method
        self.description = f"SciPy's {method}, with exact derivatives"

    def run(self, evaluator, options, warm_start):
        constraints = []
        if evaluator.m > 0:
            constraints = [
                scipy.optimize.NonlinearConstraint(
                    evaluator.constraints, 0.0, np.inf, jac=evaluator.jacobian
                )
            ]
        trust = self.method == "trust-constr"
        found = scipy.optimize.minimize(
            evaluator.cost_and_gradient,
            evaluator.start,
            jac=True,
            method=self.method,
            bounds=scipy.optimize.Bounds(evaluator.lower, evaluator.upper),
            constraints=constraints,
            options={"gtol" if trust else "ftol": options["ftol"], "maxiter": 10**6},
        )
        return evaluator.finish(
            prospect.StopReason.CONVERGED if found.success else prospect.StopReason.NUMERICAL_TROUBLE,
            optimum=found.success,
            detail=str(found.message),
        )


def prospect_plugin(registries):
    registries.add_solver(SciPy("SLSQP"))
    registries.add_solver(SciPy("trust-constr"))
