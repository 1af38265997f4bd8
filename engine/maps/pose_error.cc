// SPDX-License-Identifier: Apache-2.0
#include "engine/maps/pose_error.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "engine/maps/grid.h"

namespace prospect {

bool is_pose_covariance(const Eigen::Matrix4d& covariance) {
  constexpr double kRounding = 1e-9;
  if (!covariance.allFinite()) return false;
  const double largest = covariance.cwiseAbs().maxCoeff();
  if (largest > kFarthest * kFarthest) return false;
  if (largest == 0.0) return true;
  if ((covariance - covariance.transpose()).cwiseAbs().maxCoeff() > kRounding * largest) {
    return false;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> solver(covariance, Eigen::EigenvaluesOnly);
  return solver.eigenvalues().minCoeff() >= -kRounding * largest;
}

double position_sigma(const Eigen::Matrix4d& covariance) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance.topLeftCorner<3, 3>(),
                                                              Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0.0, solver.eigenvalues().maxCoeff()));
}

std::string unbounded_pose_error(const Belief& belief, double max_lost_error) {
  if (!is_pose_covariance(belief.covariance)) {
    return "the covariance of the pose is not finite or not positive semi-definite";
  }
  if (belief.localization != Localization::kLost) return "";
  if (belief.covariance.topLeftCorner<2, 2>().isZero(0.0)) {
    return "localization is lost and the covariance of the pose says that it is exact";
  }
  const double sigma = position_sigma(belief.covariance);
  if (sigma <= max_lost_error) return "";
  char text[120];
  std::snprintf(text, sizeof text, "localization is lost and the pose may be %.2f m off", sigma);
  return text;
}

}  // namespace prospect
