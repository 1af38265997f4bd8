// SPDX-License-Identifier: Apache-2.0
#include "engine/maps/usable_landmarks.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "models/knobs.h"

namespace prospect {
namespace {

constexpr double kLargestVariance = 1e12;  // [m^2]
constexpr double kMostDensity = 1e5;       // [1/m^2]
constexpr double kMostImageCell = 1.0;

bool has_negative_eigenvalue(const Eigen::Matrix3d& covariance) {
  const Eigen::Matrix3d S = 0.5 * (covariance + covariance.transpose());
  // Leading minors that are clearly positive settle nearly all.
  const double largest = S.cwiseAbs().maxCoeff();
  const double second = S(0, 0) * S(1, 1) - S(0, 1) * S(0, 1);
  if (S(0, 0) > 0.0 && second > 1e-9 * largest * largest &&
      S.determinant() > 1e-9 * largest * largest * largest) {
    return false;
  }
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen;
  eigen.computeDirect(S, Eigen::EigenvaluesOnly);
  return !(eigen.eigenvalues().minCoeff() >= -1e-6 * largest);
}

bool within(double value, double low, double high) { return value >= low && value <= high; }

}  // namespace

std::string fault_of(const Landmark& l, double farthest) {
  // NaN must fail: comparisons are written so that it does.
  if (!l.position.allFinite() || !(l.position.cwiseAbs().maxCoeff() <= farthest)) {
    std::ostringstream out;
    out << "position is not usable; expected finite coordinates within " << farthest << " m";
    return out.str();
  }
  if (!l.covariance.allFinite() || !(l.covariance.cwiseAbs().maxCoeff() <= kLargestVariance)) {
    return "covariance is not usable; expected finite entries up to 1e12 m^2";
  }
  if (has_negative_eigenvalue(l.covariance)) {
    return "covariance has a negative eigenvalue; expected a positive semi-definite matrix";
  }
  if (!(std::abs(l.creation_direction.norm() - 1.0) <= 1e-3)) {
    return "creation_direction has length " + std::to_string(l.creation_direction.norm()) +
           "; expected a unit vector";
  }
  if (!(l.creation_range > 0.0) || !std::isfinite(l.creation_range)) {
    return "creation_range is " + std::to_string(l.creation_range) + "; expected > 0 m";
  }
  if (!within(l.survival, 0.0, 1.0)) {
    return "survival is " + std::to_string(l.survival) + "; expected 0 to 1";
  }
  if (!(l.multiplicity > 0.0 && l.multiplicity <= kMostMultiplicity)) {
    return "multiplicity is " + std::to_string(l.multiplicity) + "; expected above 0, to 1e6";
  }
  if (!within(l.per_cell, 0.0, 1e6)) {
    return "per_cell is " + std::to_string(l.per_cell) + "; expected 0 to 1e6 / m^2";
  }
  return "";
}

UsableLandmarks usable_landmarks(std::shared_ptr<const LandmarkMap> map, const PausePoint& pause) {
  UsableLandmarks result;
  std::shared_ptr<LandmarkMap> copy;
  // Of the first `count` landmarks; there is room for all, so that it is not moved as it grows.
  const auto begin_copy = [&](std::size_t count) {
    copy = std::make_shared<LandmarkMap>();
    copy->feature_density = map->feature_density;
    copy->image_cell = map->image_cell;
    copy->odometry_noise = map->odometry_noise;
    copy->landmarks.reserve(map->landmarks.size());
    for (std::size_t i = 0; i < count; ++i) {
      if (i % 256 == 0) pause();
      copy->landmarks.push_back(map->landmarks[i]);
    }
  };
  const auto note = [&](const std::string& fault) {
    if (result.fault.empty()) result.fault = fault;
  };
  for (std::size_t i = 0; i < map->landmarks.size(); ++i) {
    if (i % 256 == 0) pause();
    const Landmark& l = map->landmarks[i];
    const std::string fault = fault_of(l);
    if (fault.empty()) {
      if (copy) copy->landmarks.push_back(l);
      continue;
    }
    note("landmark " + std::to_string(l.id) + ": " + fault);
    ++result.dropped;
    if (!copy) begin_copy(i);
  }
  const auto check = [&](double LandmarkMap::*member, double most, const std::string& what) {
    const double value = (*map).*member;
    if (within(value, 0.0, most)) return;
    note(what + " is " + std::to_string(value) + "; expected 0 to " + std::to_string(most) +
         "; taken as 0");
    if (!copy) begin_copy(map->landmarks.size());
    (*copy).*member = 0.0;
  };
  check(&LandmarkMap::feature_density, kMostDensity, "feature_density");
  check(&LandmarkMap::image_cell, kMostImageCell, "image_cell");
  try {
    if (map->odometry_noise) check_knobs("odometry_noise", *map->odometry_noise);
  } catch (const std::invalid_argument& e) {
    note(std::string(e.what()) + "; left out");
    if (!copy) begin_copy(map->landmarks.size());
    copy->odometry_noise.reset();
  }
  result.map = copy ? std::move(copy) : std::move(map);
  return result;
}

}  // namespace prospect
