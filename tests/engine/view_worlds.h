// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include "engine/maps/voxel_grid.h"
#include "engine/problem/trajectory.h"
#include "models/motion_model.h"

namespace prospect::test {

inline double uniform(std::mt19937_64& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

/// A walled hall of 16 x 16 x 2.5 m with boxes that leave the middle free; floor below z = 0;
/// unknown beyond x = 4 m where `partly_unknown`.
inline VoxelGrid hall(std::mt19937_64& random, bool partly_unknown, int boxes = 40) {
  VoxelGrid grid(GridFrame{0.1, -80, -80, 160, 160}, -0.1, 2.5);
  const auto set_box = [&](int i0, int i1, int j0, int j1, int k1, CellState s) {
    for (int i = std::max(i0, -80); i < std::min(i1, 80); ++i) {
      for (int j = std::max(j0, -80); j < std::min(j1, 80); ++j) {
        for (int k = 0; k < k1; ++k) grid.set(i, j, k, s);
      }
    }
  };
  for (int i = -80; i < 80; ++i) {
    for (int j = -80; j < 80; ++j) grid.set(i, j, -1, CellState::kOccupied);
  }
  set_box(-80, 80, -80, 80, 25, CellState::kFree);
  for (int b = 0; b < boxes; ++b) {
    const int i = static_cast<int>(uniform(random, -75, 70)),
              j = static_cast<int>(uniform(random, -75, 70));
    const int w = static_cast<int>(uniform(random, 2, 14)),
              h = static_cast<int>(uniform(random, 2, 14));
    const int k = static_cast<int>(uniform(random, 4, 25));
    if (i < 8 && i + w > -8 && j < 8 && j + h > -8) continue;
    set_box(i, i + w, j, j + h, k, CellState::kOccupied);
  }
  if (partly_unknown) set_box(40, 80, -80, 80, 25, CellState::kUnknown);
  set_box(-80, -79, -80, 80, 25, CellState::kOccupied);
  set_box(79, 80, -80, 80, 25, CellState::kOccupied);
  set_box(-80, 80, -80, -79, 25, CellState::kOccupied);
  set_box(-80, 80, 79, 80, 25, CellState::kOccupied);
  return grid;
}

/// Trajectories of the model from random starts around the origin under random admissible inputs.
inline TrajectoryBatch random_trajectories(const MotionModel& model, int N, double dt, int batch,
                                           std::mt19937_64& random, double spread = 1.0,
                                           double height = 0.0) {
  TrajectoryBatch t;
  t.horizon = {&model, N, dt};
  t.layout = model.pose_layout();
  const int nx = model.nx(), nu = model.nu();
  const InputLimits& limits = model.limits();
  const auto input = [&](int j) {
    return uniform(random, std::max(limits.lower[j], -5.0), std::min(limits.upper[j], 5.0));
  };
  t.u_previous.resize(nu);
  for (int j = 0; j < nu; ++j) t.u_previous[j] = input(j);
  t.states.resize((N + 1) * nx, batch);
  t.inputs.resize(N * nu, batch);
  for (int b = 0; b < batch; ++b) {
    const Pose start{{uniform(random, -spread, spread), uniform(random, -spread, spread), height},
                     uniform(random, -M_PI, M_PI)};
    Eigen::VectorXd x = model.state(start, {}), next(nx), u(nu);
    for (int k = 0; k <= N; ++k) {
      for (int i = 0; i < nx; ++i) t.states(k * nx + i, b) = x[i];
      if (k == N) break;
      for (int j = 0; j < nu; ++j) t.inputs(k * nu + j, b) = u[j] = input(j);
      model.step(x, u, dt, next);
      x = next;
    }
  }
  return t;
}

}  // namespace prospect::test
