// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/shared_errors.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "perception/odometry/point_observation.h"
#include "perception/odometry/track.h"

namespace prospect {
namespace {

using Eigen::Matrix3d;

constexpr int kAreas = 6;  // along each side of the image
/// Number of the image; those of its areas follow. No landmark has such a one.
constexpr std::uint64_t kImage = std::uint64_t{1} << 62;

/// L with L L^T = C, lower triangular; columns of what does not vary are zero.
Matrix3d root(const Matrix3d& C) {
  Matrix3d L = Matrix3d::Zero();
  for (int j = 0; j < 3; ++j) {
    const double rest = C(j, j) - L.row(j).head(j).squaredNorm();
    if (!(rest > 1e-12 * C(j, j))) continue;
    L(j, j) = std::sqrt(rest);
    for (int i = j + 1; i < 3; ++i) {
      L(i, j) = (C(i, j) - L.row(i).head(j).dot(L.row(j).head(j))) / L(j, j);
    }
  }
  return L;
}

}  // namespace

ObservationErrors observation_errors(const PointObservation& o, const ObservationResidual& residual,
                                     double sigma_left, double sigma_right,
                                     const SharedErrorOptions& options) {
  Matrix3d T = Matrix3d::Zero();
  T.topLeftCorner<2, 2>() = o.left_covariance;
  if (o.sees_right()) {
    T(2, 2) = o.right_variance;
    if (T(0, 0) > 0.0) {
      const double slope = options.left_right * std::sqrt(T(2, 2) / T(0, 0));
      T(0, 2) = T(2, 0) = slope * T(0, 0);
      T(1, 2) = T(2, 1) = slope * T(0, 1);
    }
  }
  const Matrix3d L = root(residual.d_measured * o.sigma.cwiseAbs2().asDiagonal() *
                              residual.d_measured.transpose() +
                          options.lasting * T);
  ObservationErrors errors;
  errors.landmark = std::sqrt(std::max(0.0, 1.0 - options.area - options.image)) * L;
  errors.area = std::sqrt(options.area) * L;
  errors.image = std::sqrt(options.image) * L;
  errors.fresh = (1.0 - options.lasting) * T;
  errors.fresh.diagonal() += Eigen::Vector3d(sigma_left * sigma_left, sigma_left * sigma_left,
                                             o.sees_right() ? sigma_right * sigma_right : 0.0);
  return errors;
}

ErrorNumbers error_numbers(const Track& track, double width, double height) {
  const auto part = [](double x, double of) {
    return static_cast<std::uint64_t>(std::clamp(static_cast<int>(kAreas * x / of), 0, kAreas - 1));
  };
  return {track.id,
          kImage + 1 + kAreas * part(track.left.y(), height) + part(track.left.x(), width), kImage};
}

const std::vector<std::uint64_t>& numbers_of_areas() {
  static const std::vector<std::uint64_t> numbers = [] {
    std::vector<std::uint64_t> all(kAreas * kAreas + 1);
    std::iota(all.begin(), all.end(), kImage);
    return all;
  }();
  return numbers;
}

}  // namespace prospect
