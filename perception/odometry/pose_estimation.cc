// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/pose_estimation.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <random>

#include "engine/support/cholesky.h"
#include "engine/support/eigenvalues.h"

namespace prospect {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;

constexpr int kMinInliers = 6;

Vector3d in_world(const StereoCamera& camera, const PointObservation& o) {
  return o.T_WA * camera.triangulate(o.measured.x(), o.measured.y(), o.measured.z());
}

/// Gauss-Newton on three points of the left image; false if it does not settle.
bool three_point_pose(const StereoCamera& camera, const Vector3d points[3],
                      const Eigen::Vector2d seen[3], Isometry3d& T) {
  const PinholeCamera& left = camera.left;
  for (int iteration = 0; iteration < 12; ++iteration) {
    Matrix6d J;
    Vector6d r;
    for (int i = 0; i < 3; ++i) {
      const Vector3d Y = T * points[i];
      if (!(Y.z() > 0.01)) return false;
      const Eigen::Matrix<double, 2, 3> P = left.projection_jacobian(Y);
      r.segment<2>(2 * i) = seen[i] - left.project(Y);
      J.block<2, 3>(2 * i, 0) = P;
      J.block<2, 3>(2 * i, 3) = -P * skew(Y);
    }
    const Vector6d xi = J.partialPivLu().solve(r);
    if (!xi.allFinite() || xi.tail<3>().norm() > 1.0) return false;
    T = exp_se3(xi) * T;
    if (r.cwiseAbs().maxCoeff() < 1e-3) return true;
  }
  return false;
}

}  // namespace

double PoseEstimate::sigma_position() const {
  const Matrix3d block = covariance.topLeftCorner<3, 3>();
  if (!block.allFinite()) return std::numeric_limits<double>::infinity();
  return std::sqrt(std::max(
      0.0,
      Eigen::SelfAdjointEigenSolver<Matrix3d>(block, Eigen::EigenvaluesOnly).eigenvalues()[2]));
}

double PoseEstimate::sigma_rotation() const {
  const Matrix3d block = covariance.bottomRightCorner<3, 3>();
  if (!block.allFinite()) return std::numeric_limits<double>::infinity();
  return std::sqrt(std::max(
      0.0,
      Eigen::SelfAdjointEigenSolver<Matrix3d>(block, Eigen::EigenvaluesOnly).eigenvalues()[2]));
}

PoseEstimate ransac_pose(const StereoCamera& camera,
                         const std::vector<PointObservation>& observations, const Isometry3d& prior,
                         std::uint64_t seed, const PoseEstimatorOptions& options) {
  PoseEstimate best;
  best.T_CW = prior;
  const int n = static_cast<int>(observations.size());
  best.inlier.assign(n, 0);
  if (n < kMinInliers) return best;
  // Whitening seen from the prior.
  std::vector<Eigen::Matrix2d> weights(n, Eigen::Matrix2d::Zero());
  std::vector<Vector3d> points(n, Vector3d::Zero());
  for (int i = 0; i < n; ++i) {
    ObservationResidual residual;
    if (!(observations[i].measured.z() > 0.0)) continue;
    points[i] = in_world(camera, observations[i]);
    if (!observation_residual(camera, prior, observations[i], observations[i].measured, residual)) {
      continue;
    }
    Eigen::Matrix2d S = (residual.d_measured * observations[i].sigma.cwiseAbs2().asDiagonal() *
                         residual.d_measured.transpose())
                            .topLeftCorner<2, 2>() +
                        observations[i].left_covariance;
    S.diagonal().array() += options.sigma_left * options.sigma_left;
    weights[i] = S.inverse();
  }
  std::mt19937_64 generator(seed);
  // Not std::uniform_int_distribution, whose results differ between standard libraries.
  const auto draw = [&] { return static_cast<int>(generator() % static_cast<std::uint64_t>(n)); };
  int needed = options.ransac_hypotheses;
  double best_cost = std::numeric_limits<double>::infinity();
  // Number and cost of those that agree; MSAC: how well they agree counts, too.
  std::vector<char> inlier(n);
  const auto score = [&](const Isometry3d& T, int& count) {
    count = 0;
    double cost = 0.0;
    for (int i = 0; i < n; ++i) {
      const Vector3d Y = T * points[i];
      inlier[i] = 0;
      double chi2 = options.ransac_gate;
      if (Y.z() > 0.01 && weights[i](0, 0) > 0.0) {
        const Eigen::Vector2d r = observations[i].left - camera.left.project(Y);
        const double squared = r.dot(weights[i] * r);
        if (squared <= options.ransac_gate) {
          chi2 = squared;
          inlier[i] = 1;
          ++count;
        }
      }
      cost += chi2;
    }
    return cost;
  };
  for (int h = 0; h < needed; ++h) {
    Isometry3d T = prior;
    // The prior itself is the first hypothesis.
    if (h > 0) {
      const int a = draw(), b = draw(), c = draw();
      if (a == b || b == c || a == c) continue;
      const Vector3d three[3] = {points[a], points[b], points[c]};
      const Eigen::Vector2d seen[3] = {observations[a].left, observations[b].left,
                                       observations[c].left};
      if (!three_point_pose(camera, three, seen, T)) continue;
    }
    int count = 0;
    double cost = score(T, count);
    // Three noisy points give a rough pose: before a new best is judged it is refined on those that
    // agree with it, as long as that helps (LO-RANSAC: Chum, Matas, Kittler 2003).
    for (int round = 0; cost < best_cost; ++round) {
      best_cost = cost;
      best.T_CW = T;
      best.inlier = inlier;
      best.inliers = count;
      if (round == 4 || count < kMinInliers) break;
      const PoseEstimate refined = refine_pose(camera, observations, best.inlier, T, options);
      if (!refined.solved) break;
      T = refined.T_CW;
      cost = score(T, count);
    }
    const double share = static_cast<double>(best.inliers) / n;
    const double miss = 1.0 - share * share * share;
    if (h > 0 && miss < 1.0) {
      const double enough =
          miss <= 0.0 ? 1.0 : std::log(1.0 - options.ransac_confidence) / std::log(miss);
      needed = static_cast<int>(
          std::min<double>(options.ransac_hypotheses, std::ceil(std::max(enough, 10.0))));
    }
  }
  best.solved = best.inliers >= kMinInliers && 5 * best.inliers >= n;
  return best;
}

PoseEstimate refine_pose(const StereoCamera& camera,
                         const std::vector<PointObservation>& observations,
                         const std::vector<char>& use, const Isometry3d& start,
                         const PoseEstimatorOptions& options) {
  PoseEstimate estimate;
  const int n = static_cast<int>(observations.size());
  estimate.T_CW = start;
  estimate.inlier.assign(n, 1);
  if (!use.empty()) estimate.inlier = use;
  std::vector<Vector3d>& m = estimate.measured;
  for (const PointObservation& o : observations) m.push_back(o.measured);
  struct Linearised {
    bool valid = false;
    ObservationResidual residual;
    Matrix3d W;
  };
  std::vector<Linearised> linear(n);
  // At the pose and the points there are. The residual is as if m were the measurement: what is
  // left to explain by pose and noise.
  const auto linearise = [&](int i) {
    auto& [valid, residual, W] = linear[i];
    valid = observation_residual(camera, estimate.T_CW, observations[i], m[i], residual);
    if (!valid) return;
    residual.r += residual.d_measured * (observations[i].measured - m[i]);
    W = observation_weight(observations[i], residual, options.sigma_left, options.sigma_right);
  };
  /// m given the pose and, to first order, its step xi.
  const auto correct = [&](int i, const Vector6d& xi) {
    const PointObservation& o = observations[i];
    const auto& [valid, residual, W] = linear[i];
    const Vector3d corrected = o.measured - o.sigma.cwiseAbs2().asDiagonal() *
                                                residual.d_measured.transpose() * W *
                                                (residual.r + residual.d_pose * xi);
    // A point that is fitted beyond infinity stays where it is.
    if (corrected.z() > 0.1 * o.measured.z()) m[i] = corrected;
  };
  for (int round = 0; round < 4; ++round) {
    const bool robust = round == 0;
    for (int iteration = 0; iteration < 10; ++iteration) {
      Matrix6d H = Matrix6d::Zero();
      Vector6d g = Vector6d::Zero();
      for (int i = 0; i < n; ++i) {
        if (!estimate.inlier[i]) continue;
        // The gate of the round before has done it for the first iteration.
        if (robust || iteration > 0) linearise(i);
        const auto& [valid, residual, W] = linear[i];
        if (!valid) continue;
        Matrix3d weight = W;
        if (robust) {
          const double norm = std::sqrt(residual.r.dot(W * residual.r));
          if (norm > options.huber) weight *= options.huber / norm;
        }
        const Eigen::Matrix<double, 6, 3> JW = residual.d_pose.transpose() * weight;
        H.noalias() += JW * residual.d_pose;
        g.noalias() += JW * residual.r;
      }
      const Eigen::LDLT<Matrix6d> solver(H);
      if (solver.info() != Eigen::Success || !solver.isPositive()) return estimate;
      const Vector6d xi = -solver.solve(g);
      if (!xi.allFinite()) return estimate;
      for (int i = 0; i < n; ++i) {
        if (estimate.inlier[i] && linear[i].valid) correct(i, xi);
      }
      estimate.T_CW = exp_se3(xi) * estimate.T_CW;
      if (xi.norm() < 1e-7) break;
    }
    // Gate all that may be used, so that a point can come back; then solve again without loss.
    bool changed = false;
    int inliers = 0;
    double chi2_sum = 0.0;
    int dof = -6;
    Matrix6d H = Matrix6d::Zero();
    for (int i = 0; i < n; ++i) {
      if (!use.empty() && !use[i]) continue;
      char in = 0;
      linearise(i);
      const auto& [valid, residual, W] = linear[i];
      if (valid) {
        const double chi2 = residual.r.dot(W * residual.r);
        in = chi2 <= options.final_gate;
        if (in) {
          ++inliers;
          chi2_sum += chi2;
          dof += observations[i].sees_right() ? 3 : 2;
          H.noalias() += residual.d_pose.transpose() * W * residual.d_pose;
        }
      }
      if (in != estimate.inlier[i]) changed = true;
      estimate.inlier[i] = in;
    }
    estimate.inliers = inliers;
    if (inliers < kMinInliers) return estimate;
    estimate.information = H;
    estimate.chi2_per_dof = dof > 0 ? chi2_sum / dof : 0.0;
    estimate.degrees = std::max(0, dof);
    if (!robust && !changed) break;
  }
  const Eigen::SelfAdjointEigenSolver<Matrix6d> spectrum(estimate.information);
  estimate.solved = spectrum.info() == Eigen::Success && estimate.T_CW.matrix().allFinite();
  // Below this the direction is known to no better than 30 m or 30 rad: not at all.
  if (!estimate.solved || spectrum.eigenvalues()[0] < 1e-3) {
    estimate.solved = false;
    estimate.covariance.setZero();
    estimate.covariance.diagonal().setConstant(std::numeric_limits<double>::infinity());
    return estimate;
  }
  estimate.covariance = std::max(1.0, estimate.chi2_per_dof) * spectrum.eigenvectors() *
                        spectrum.eigenvalues().cwiseInverse().asDiagonal() *
                        spectrum.eigenvectors().transpose();
  return estimate;
}

}  // namespace prospect
