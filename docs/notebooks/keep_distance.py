# SPDX-License-Identifier: Apache-2.0
"""A term of one's own: keeps away from a point, such as a person."""

import numpy as np
import prospect


class KeepDistance(prospect.Term):
    """T = 1/N sum_k exp(-|p_k - q|^2 / (2 r^2)), k = 1..N: 1 while the robot stands on q."""

    name = "keep_distance"
    unit = "-"
    lower_bound = 0.0

    def __init__(self, x, y, radius):
        self.q, self.r = np.array([x, y]), radius

    def closeness(self, t):
        d = t.poses[:, 1:, :2] - self.q  # (B, N, 2)
        return d, np.exp(-(d**2).sum(axis=2) / (2 * self.r**2))

    def value(self, t):
        return self.closeness(t)[1].mean(axis=1)

    def gradient(self, t):
        d, closeness = self.closeness(t)
        by_pose = np.zeros((t.N + 1, 4))  # x, y, z, yaw
        by_pose[1:, :2] = -closeness[0][:, None] * d[0] / (t.N * self.r**2)
        return {"poses": by_pose}


def prospect_plugin(registries):
    registries.add_term(
        "keep_distance",
        lambda options, context: KeepDistance(**options),
        options={
            "x": (0.0, -1e4, 1e4, "m", "of the point, in W"),
            "y": (0.0, -1e4, 1e4, "m", "of the point, in W"),
            "radius": (0.5, 0.05, 10.0, "m", "distance at which it is down to 0.61"),
        },
        description="closeness to a point, such as a person",
    )
