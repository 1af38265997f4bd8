# SPDX-License-Identifier: Apache-2.0
"""Terms and problems that several tests use."""

import numpy as np
import prospect


class Attraction(prospect.Term):
    """Mean squared distance of the poses to a point, and the squared inputs."""

    name = "attraction"
    unit = "m^2"
    lower_bound = 0.0

    def __init__(self, x, y):
        self.point = np.array([x, y])

    def value(self, t):
        d = t.poses[:, 1:, :2] - self.point
        return (d**2).sum((1, 2)) / t.N + 0.1 * (t.inputs**2).sum((1, 2)) / t.N

    def gradient(self, t):
        poses = np.zeros((t.N + 1, 4))
        poses[1:, :2] = 2 * (t.poses[0, 1:, :2] - self.point) / t.N
        return {"poses": poses, "inputs": 0.2 * t.inputs[0] / t.N}


class Corridor(prospect.Term):
    """Every pose stays within |y| <= width: width^2 - y^2 >= 0."""

    name = "corridor"
    unit = "m^2"

    def __init__(self, width):
        self.width = width

    def rows(self, N):
        return N

    def value(self, t):
        return self.width**2 - t.poses[:, 1:, 1] ** 2

    def jacobian(self, t):
        poses = np.zeros((t.N, t.N + 1, 4))
        k = np.arange(t.N)
        poses[k, k + 1, 1] = -2 * t.poses[0, 1:, 1]
        return {"poses": poses}


def path_problem(constrained=True):
    """A unicycle at rest that is drawn to (2, 1). n = 10, m = 20."""
    terms = [(Attraction(2.0, 1.0), 0.5)] + ([Corridor(0.6)] if constrained else [])
    return prospect.Problem(prospect.motion_model("unicycle"), [0.0, 0.0, 0.2], terms, M=5)


def rosenbrock():
    return prospect.Problem.from_functions(
        [-2, -2],
        [2, 2],
        lambda z: (1 - z[0]) ** 2 + 100 * (z[1] - z[0] ** 2) ** 2,
        lambda z: np.array(
            [-2 * (1 - z[0]) - 400 * z[0] * (z[1] - z[0] ** 2), 200 * (z[1] - z[0] ** 2)]
        ),
        start=[-1.2, 1],
    )
