// SPDX-License-Identifier: Apache-2.0
#include "perception/places/view_alignment.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <utility>
#include <vector>

#include "perception/odometry/pose_estimation.h"

namespace prospect {
namespace {

using Eigen::Isometry3d;

/// The nearest descriptors to each of some, as far as they were looked at.
struct Nearest {
  int index = -1, bits = 257, next = 257;

  void look(int i, int d) {
    if (d < bits) {
      next = std::exchange(bits, d);
      index = i;
    } else {
      next = std::min(next, d);
    }
  }
  bool is_clear(const ViewAlignmentOptions& options) const {
    return bits <= options.most_bits && bits <= options.distinctness * next;
  }
};

struct Pair {
  const StereoView::Point* a;
  const StereoView::Point* b;
};

std::vector<Pair> pairs(const StereoView& a, const StereoView& b,
                        const ViewAlignmentOptions& options) {
  std::vector<Nearest> of_a(a.points.size()), of_b(b.points.size());
  for (std::size_t i = 0; i < of_a.size(); ++i) {
    for (std::size_t j = 0; j < of_b.size(); ++j) {
      const int d = distance(a.points[i].descriptor, b.points[j].descriptor);
      of_a[i].look(static_cast<int>(j), d);
      of_b[j].look(static_cast<int>(i), d);
    }
  }
  std::vector<Pair> result;
  for (std::size_t i = 0; i < of_a.size(); ++i) {
    if (!of_a[i].is_clear(options)) continue;
    const auto j = static_cast<std::size_t>(of_a[i].index);
    if (of_b[j].index == static_cast<int>(i) && of_b[j].is_clear(options)) {
      result.push_back({&a.points[i], &b.points[j]});
    }
  }
  return result;
}

/// The corners that have a depth in the first view of each pair, as the second one sees them.
std::vector<PointObservation> observations(const std::vector<Pair>& pairs, bool from_b,
                                           double sigma) {
  std::vector<PointObservation> result;
  for (const auto& [a, b] : pairs) {
    const StereoView::Point& made = from_b ? *b : *a;
    const StereoView::Point& seen = from_b ? *a : *b;
    if (!made.has_depth()) continue;
    PointObservation o;
    o.measured << made.pixel, made.disparity;
    o.sigma << sigma * made.scale, sigma * made.scale, made.sigma_disparity;
    o.left = seen.pixel;
    const double variance = sigma * sigma * seen.scale * seen.scale;
    o.left_covariance = variance * Eigen::Matrix2d::Identity();
    if (seen.has_depth()) {
      o.right = seen.pixel.x() - seen.disparity;
      o.right_variance = variance + seen.sigma_disparity * seen.sigma_disparity;
    }
    result.push_back(o);
  }
  return result;
}

/// The pose of the second camera, as T_CW with W the first one.
std::optional<PoseEstimate> pose_of(const StereoCamera& camera,
                                    const std::vector<PointObservation>& seen,
                                    const ViewAlignmentOptions& options) {
  constexpr int kHypotheses = 200;
  constexpr float kGate = 4.0F;  // [px]
  if (static_cast<int>(seen.size()) < options.least_inliers) return std::nullopt;
  std::vector<cv::Point3d> points;
  std::vector<cv::Point2d> pixels;
  for (const PointObservation& o : seen) {
    const Eigen::Vector3d p = camera.triangulate(o.measured.x(), o.measured.y(), o.measured.z());
    points.emplace_back(p.x(), p.y(), p.z());
    pixels.emplace_back(o.left.x(), o.left.y());
  }
  const PinholeCamera& c = camera.left;
  const cv::Matx33d K(c.fx, 0.0, c.cx, 0.0, c.fy, c.cy, 0.0, 0.0, 1.0);
  cv::Vec3d rotation, translation;
  std::vector<int> agree;
  if (!cv::solvePnPRansac(points, pixels, K, cv::noArray(), rotation, translation, false,
                          kHypotheses, kGate, 0.99, agree, cv::SOLVEPNP_P3P) ||
      static_cast<int>(agree.size()) < options.least_inliers) {
    return std::nullopt;
  }
  const Eigen::Vector3d turn(rotation[0], rotation[1], rotation[2]);
  Isometry3d start = Isometry3d::Identity();
  if (turn.norm() > 0.0)
    start.linear() = Eigen::AngleAxisd(turn.norm(), turn.normalized()).matrix();
  start.translation() << translation[0], translation[1], translation[2];
  if (!start.matrix().allFinite()) return std::nullopt;
  std::vector<char> use(seen.size(), 0);
  for (const int i : agree) use[static_cast<std::size_t>(i)] = 1;
  PoseEstimate estimate = refine_pose(camera, seen, use, start);
  if (!estimate.solved || estimate.inliers < options.least_inliers) return std::nullopt;
  return estimate;
}

}  // namespace

std::optional<ViewAlignment> align_views(const StereoCamera& camera, const StereoView& a,
                                         const StereoView& b, const ViewAlignmentOptions& options) {
  const std::vector<Pair> both = pairs(a, b, options);
  const auto b_in_a = pose_of(camera, observations(both, false, options.sigma), options);
  if (!b_in_a) return std::nullopt;
  const auto a_in_b = pose_of(camera, observations(both, true, options.sigma), options);
  if (!a_in_b) return std::nullopt;
  // T_ba of both ways.
  const Isometry3d apart = b_in_a->T_CW * a_in_b->T_CW;
  if (apart.translation().norm() > options.most_apart ||
      Eigen::AngleAxisd(apart.linear()).angle() > options.most_turned) {
    return std::nullopt;
  }
  // The estimate's error is exp(e) on T_ba, so exp(-e) on T_ab from the right.
  ViewAlignment result;
  result.measured.T = b_in_a->T_CW.inverse();
  result.measured.information = b_in_a->covariance.inverse();
  result.measured.information =
      0.5 * (result.measured.information + result.measured.information.transpose()).eval();
  result.inliers = std::min(b_in_a->inliers, a_in_b->inliers);
  if (!is_information(result.measured.information)) return std::nullopt;
  return result;
}

}  // namespace prospect
