// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/pybind11.h>

#include <Eigen/Core>

#include "engine/problem/trajectory.h"

namespace prospect::python {

/// A batch of trajectories as Python sees it: a copy, laid out as numpy does by default.
struct Trajectories {
  explicit Trajectories(const TrajectoryBatch& batch);

  int B, N, nx, nu;
  double dt;  ///< [s]
  PoseLayout layout;
  Eigen::VectorXd u_previous;  ///< nu
  Eigen::VectorXd states;      ///< [b, k, i]: B (N+1) nx
  Eigen::VectorXd inputs;      ///< [b, k, j]: B N nu
  Eigen::VectorXd poses;       ///< [b, k, (x, y, z, yaw)]: B (N+1) 4
};

void bind_trajectories(pybind11::module_& m);

}  // namespace prospect::python
