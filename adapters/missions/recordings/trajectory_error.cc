// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/recordings/trajectory_error.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <utility>

#include "adapters/formats/datasets/degrees.h"
#include "perception/odometry/median.h"

namespace prospect {
namespace {

double rotation_angle(const Eigen::Isometry3d& T) { return Eigen::AngleAxisd(T.linear()).angle(); }

/// Of the estimated turns since the first pair: how far off the true ones they are, in the median,
/// and how large [rad]; of pairs that have turned.
struct TurnError {
  double error = 0.0, turn = 0.0;
  int count = 0;
};
TurnError turn_error(const std::vector<PosePair>& pairs) {
  constexpr double kTurned = 0.035;  // [rad]
  std::vector<double> errors, turns;
  for (const PosePair& p : pairs) {
    const Eigen::Isometry3d estimated = pairs[0].estimate.inverse() * p.estimate;
    const double turn = rotation_angle(estimated);
    if (turn < kTurned) continue;
    errors.push_back(rotation_angle(estimated.inverse() * pairs[0].truth.inverse() * p.truth));
    turns.push_back(turn);
  }
  if (errors.empty()) return {};
  const int count = static_cast<int>(errors.size());
  return {median(errors), median(turns), count};
}

}  // namespace

std::vector<PosePair> associate(const Trajectory& estimate, const Trajectory& truth,
                                double max_gap) {
  std::vector<PosePair> pairs;
  for (const TimedPose& e : estimate) {
    const auto T = pose_at(truth, e.stamp, max_gap);
    if (T) pairs.push_back({e.stamp, e.T, *T});
  }
  return pairs;
}

std::string quaternion_order_problem(const std::vector<PosePair>& pairs,
                                     const std::vector<PosePair>& w_first) {
  const TurnError read = turn_error(pairs), again = turn_error(w_first);
  if (again.count < 3 || read.error < 0.25 * read.turn || again.error > 0.25 * again.turn ||
      again.error > 0.5 * read.error) {
    return {};
  }
  char text[200];
  std::snprintf(
      text, sizeof text,
      "the ground truth's turns are off the estimated ones by %.2f deg in the median, and "
      "by %.2f deg if its quaternions have w first; expected stamp tx ty tz qx qy qz qw",
      kDegrees * read.error, kDegrees * again.error);
  return text;
}

double path_length(const std::vector<PosePair>& pairs) {
  double length = 0.0;
  for (std::size_t i = 1; i < pairs.size(); ++i) {
    length += (pairs[i].truth.translation() - pairs[i - 1].truth.translation()).norm();
  }
  return length;
}

AbsoluteError absolute_error(const std::vector<PosePair>& pairs, Alignment alignment) {
  AbsoluteError error;
  if (pairs.empty()) return error;
  Eigen::Isometry3d A = pairs[0].truth * pairs[0].estimate.inverse();
  if (alignment == Alignment::kBestFit) {
    Eigen::Vector3d from = Eigen::Vector3d::Zero(), to = Eigen::Vector3d::Zero();
    for (const PosePair& p : pairs) {
      from += p.estimate.translation() / static_cast<double>(pairs.size());
      to += p.truth.translation() / static_cast<double>(pairs.size());
    }
    Eigen::Matrix3d cross = Eigen::Matrix3d::Zero();
    for (const PosePair& p : pairs) {
      cross += (p.truth.translation() - to) * (p.estimate.translation() - from).transpose();
    }
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(cross, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Eigen::Matrix3d sign = Eigen::Matrix3d::Identity();
    if (svd.matrixU().determinant() * svd.matrixV().determinant() < 0.0) sign(2, 2) = -1.0;
    A.linear() = svd.matrixU() * sign * svd.matrixV().transpose();
    A.translation() = to - A.linear() * from;
  }
  std::vector<double> distances;
  double squares = 0.0;
  for (const PosePair& p : pairs) {
    distances.push_back((A * p.estimate.translation() - p.truth.translation()).norm());
    squares += distances.back() * distances.back();
  }
  error.rmse = std::sqrt(squares / static_cast<double>(pairs.size()));
  error.max = *std::max_element(distances.begin(), distances.end());
  error.median = median(distances);
  return error;
}

EndError end_error(const std::vector<PosePair>& pairs) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EndError error{nan, nan, nan};
  if (pairs.size() < 2) return error;
  const PosePair& a = pairs.front();
  const PosePair& b = pairs.back();
  const Eigen::Isometry3d E =
      (a.truth.inverse() * b.truth).inverse() * (a.estimate.inverse() * b.estimate);
  error.translation = E.translation().norm();
  const double length = path_length(pairs);
  if (length > 0.0) error.share = error.translation / length;
  error.rotation = rotation_angle(E);
  return error;
}

TrajectoryErrors trajectory_errors(const std::vector<PosePair>& pairs) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  if (pairs.size() < 2) return {{kNaN, kNaN, kNaN}, {kNaN, kNaN, kNaN}, {kNaN, kNaN, kNaN}};
  return {absolute_error(pairs, Alignment::kFirstPose), absolute_error(pairs, Alignment::kBestFit),
          end_error(pairs)};
}

RelativeError relative_error(const std::vector<PosePair>& pairs, double length) {
  RelativeError error;
  std::vector<double> along(pairs.size(), 0.0);
  for (std::size_t i = 1; i < pairs.size(); ++i) {
    along[i] =
        along[i - 1] + (pairs[i].truth.translation() - pairs[i - 1].truth.translation()).norm();
  }
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const auto end = std::lower_bound(along.begin() + i, along.end(), along[i] + length);
    if (end == along.end()) break;
    const std::size_t j = end - along.begin();
    const double passed = along[j] - along[i];
    if (!(passed > 0.0)) continue;
    const Eigen::Isometry3d E = (pairs[i].truth.inverse() * pairs[j].truth).inverse() *
                                (pairs[i].estimate.inverse() * pairs[j].estimate);
    error.translation += E.translation().norm() / passed;
    error.rotation += rotation_angle(E) / passed;
    ++error.segments;
  }
  if (error.segments > 0) {
    error.translation /= error.segments;
    error.rotation /= error.segments;
  }
  return error;
}

ScaleAgreement scale_of(const std::vector<PosePair>& pairs) {
  constexpr int kSegments = 20;
  constexpr double kShortest = 0.1;  // [m]: what truths are good for, some millimetres, is little
  const double length = std::max(kShortest, path_length(pairs) / kSegments);
  std::vector<double> log_ratios;
  double along = 0.0;
  for (std::size_t begin = 0, end = 1; end < pairs.size(); ++end) {
    along += (pairs[end].truth.translation() - pairs[end - 1].truth.translation()).norm();
    if (along < length * (1.0 - 1e-9)) continue;
    const double truth = (pairs[end].truth.translation() - pairs[begin].truth.translation()).norm();
    const double estimate =
        (pairs[end].estimate.translation() - pairs[begin].estimate.translation()).norm();
    begin = end;
    along = 0.0;
    // A truth that trembles makes a way without getting anywhere.
    if (truth > 0.5 * length && estimate > 0.0) log_ratios.push_back(std::log(estimate / truth));
  }
  return scale_agreement(std::move(log_ratios), 0.0, 0.0);
}

}  // namespace prospect
