// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <chrono>
#include <limits>
#include <vector>

#include "perception/odometry/relative_pose.h"

namespace prospect {

/// A measurement between two poses of an estimate, with its whitened error
///   r = root (e(T_a, T_b, T) - drift beta),   root^T root = information,
/// e by measurement_error(), beta the error that all odometry has in common.
struct GraphEdge {
  int a = 0, b = 0;
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  Eigen::Matrix<double, 6, 6> root = Eigen::Matrix<double, 6, 6>::Identity();
  Eigen::Matrix<double, 6, 6> drift = Eigen::Matrix<double, 6, 6>::Zero();  ///< zero of a loop
  bool odometry = false;
};
GraphEdge loop_edge(int a, int b, const RelativePose& measured);

/// The poses of a graph and beta.
///
/// Steps of odometry err alike: a camera that looks 0.1 degrees aside, a wheel that is larger than
/// told. With independent errors alone, a thousand steps would seem far surer than they are. So
/// each step errs by n + diag(sigma) beta, sigma the standard deviations that its information
/// claims, beta ~ N(0, drift_sigma^2 I) the same for all steps.
struct GraphEstimate {
  std::vector<Eigen::Isometry3d> poses;  ///< T_W_k; the first one is held
  Eigen::Matrix<double, 6, 1> beta = Eigen::Matrix<double, 6, 1>::Zero();
  bool planar = false;  ///< poses move along x, y and about z of their own only

  /// Directions of (t, omega) in which a pose moves.
  std::vector<int> directions() const;
};

/// r; in by_b, if it is there, dr/dxi_b (by_a is -by_b Ad(T_b^-1 T_a)).
Eigen::Matrix<double, 6, 1> whitened_error(const GraphEdge& edge, const GraphEstimate& estimate,
                                           Eigen::Matrix<double, 6, 6>* by_b = nullptr);

/// When to stop. Iterations make the same bits everywhere, a deadline does not.
struct GraphBudget {
  int iterations = std::numeric_limits<int>::max();  ///< of the solver, each once through the graph
  std::chrono::steady_clock::time_point deadline = std::chrono::steady_clock::time_point::max();

  bool over() const { return iterations <= 0 || std::chrono::steady_clock::now() >= deadline; }
};

/// Levenberg-Marquardt by Ceres, on one thread, with a sparse Cholesky decomposition:
///   min over poses, beta   sum |r|^2 + |beta|^2 / drift_sigma^2,
/// until an iteration lowers it by less than the share `tolerance`, or the budget is spent, from
/// which it takes its iterations; one is done in any case. Returns whether it has converged. The
/// estimate is never worse than before.
bool solve_graph(const std::vector<const GraphEdge*>& edges, double drift_sigma, double tolerance,
                 GraphBudget& budget, GraphEstimate& estimate);

}  // namespace prospect
