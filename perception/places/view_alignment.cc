// SPDX-License-Identifier: Apache-2.0
#include "perception/places/view_alignment.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "perception/odometry/drift_measurement.h"
#include "perception/odometry/pose_drift.h"
#include "perception/odometry/pose_estimation.h"
#include "perception/odometry/se3.h"
#include "perception/odometry/track.h"

namespace prospect {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

/// [px of its level] within which two corners are one place, found at several levels.
constexpr double kSamePlace = 4.0;

/// Corners of two views, by their indices.
using Pairs = std::vector<std::pair<int, int>>;

bool same_place(const StereoView::Point& p, const StereoView::Point& q) {
  const double near = kSamePlace * std::max(p.scale, q.scale);
  return (p.pixel - q.pixel).squaredNorm() <= near * near;
}

/// How alike all corners of two views are.
class Likeness {
 public:
  Likeness(const StereoView& a, const StereoView& b) : a_(a), b_(b) {
    bits_.resize(a.points.size() * b.points.size());
    for (std::size_t i = 0; i < a.points.size(); ++i) {
      distances(a.points[i].descriptor, b, bits_.data() + i * b.points.size());
    }
  }
  int bits(int i, int j) const {
    return bits_[static_cast<std::size_t>(i) * b_.points.size() + static_cast<std::size_t>(j)];
  }

  /// Each other's nearest, and clearly so.
  Pairs clear(const ViewAlignmentOptions& options) const {
    const std::vector<int> of_a =
        nearest(a_, b_, options, [&](int i, int j) { return bits(i, j); });
    const std::vector<int> of_b =
        nearest(b_, a_, options, [&](int j, int i) { return bits(i, j); });
    Pairs pairs;
    for (int i = 0; i < static_cast<int>(of_a.size()); ++i) {
      const int j = of_a[static_cast<std::size_t>(i)];
      if (j >= 0 && of_b[static_cast<std::size_t>(j)] == i) pairs.emplace_back(i, j);
    }
    return pairs;
  }

 private:
  template <typename Bits>
  static std::vector<int> nearest(const StereoView& of, const StereoView& in,
                                  const ViewAlignmentOptions& options, const Bits& bits) {
    std::vector<int> result;
    const int n = static_cast<int>(in.points.size());
    for (int i = 0; i < static_cast<int>(of.points.size()); ++i) {
      int best = -1, least = options.most_bits + 1;
      for (int j = 0; j < n; ++j) {
        if (bits(i, j) < least) least = bits(i, j), best = j;
      }
      if (best >= 0) {
        // One place is found at several levels, where it looks much the same.
        const StereoView::Point& found = in.points[static_cast<std::size_t>(best)];
        for (int j = 0; j < n && best >= 0; ++j) {
          if (options.distinctness * bits(i, j) < least &&
              !same_place(found, in.points[static_cast<std::size_t>(j)])) {
            best = -1;
          }
        }
      }
      result.push_back(best);
    }
    return result;
  }

  const StereoView& a_;
  const StereoView& b_;
  std::vector<std::int16_t> bits_;
};

/// One way: corners that `made` has in space, as `seen` sees them.
class Way {
 public:
  Way(const StereoCamera& camera, const StereoView& made, const StereoView& seen,
      const ViewPrior& prior, const ViewAlignmentOptions& options)
      : camera_(camera), made_(made), seen_(seen), prior_(prior), options_(options) {
    for (const StereoView::Point& p : made.points) {
      points_.push_back(p.has_depth() ? camera.triangulate(p.pixel.x(), p.pixel.y(), disparity(p))
                                      : Vector3d(0.0, 0.0, 0.0));
    }
  }

  /// Pairs of corners, nearest in looks, that lie within `radius` [px of their level] of where they
  /// are by the pose.
  template <typename Bits>
  Pairs near(const Isometry3d& T_SM, double radius, const Bits& bits) const {
    constexpr double kScale = 1.5;  // between sizes
    struct Nearest {
      int index = -1, bits = 257;
    };
    std::vector<Nearest> of_seen(seen_.points.size());
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (!(points_[i].z() > 0.0)) continue;
      const Vector3d Y = T_SM * points_[i];
      if (!(Y.z() > 0.1)) continue;
      const Eigen::Vector2d p = camera_.left.project(Y);
      if (!camera_.left.in_image(p)) continue;
      const double scale = made_.points[i].scale * points_[i].z() / Y.z();
      Nearest best;
      for (std::size_t j = 0; j < seen_.points.size(); ++j) {
        const StereoView::Point& q = seen_.points[j];
        const double reach = radius * q.scale;
        if (std::abs(q.pixel.x() - p.x()) > reach || std::abs(q.pixel.y() - p.y()) > reach ||
            q.scale > kScale * scale || scale > kScale * q.scale) {
          continue;
        }
        const int d = bits(static_cast<int>(i), static_cast<int>(j));
        if (d < best.bits) best = {static_cast<int>(j), d};
      }
      if (best.bits > options_.most_bits) continue;
      Nearest& other = of_seen[static_cast<std::size_t>(best.index)];
      if (best.bits < other.bits) other = {static_cast<int>(i), best.bits};
    }
    Pairs pairs;
    for (std::size_t j = 0; j < of_seen.size(); ++j) {
      if (of_seen[j].index >= 0) pairs.emplace_back(of_seen[j].index, static_cast<int>(j));
    }
    return pairs;
  }

  std::vector<PointObservation> observations(const Pairs& pairs) const {
    std::vector<PointObservation> result;
    const double sigma = options_.sigma;
    for (const auto& [i, j] : pairs) {
      const StereoView::Point& made = made_.points[static_cast<std::size_t>(i)];
      const StereoView::Point& seen = seen_.points[static_cast<std::size_t>(j)];
      if (!made.has_depth()) continue;
      PointObservation o;
      o.measured << made.pixel, disparity(made);
      o.sigma << sigma * made.scale, sigma * made.scale, sigma_disparity(made);
      o.left = seen.pixel;
      const double variance = sigma * sigma * seen.scale * seen.scale;
      o.left_covariance = variance * Eigen::Matrix2d::Identity();
      if (seen.has_depth()) {
        o.right = seen.pixel.x() - disparity(seen);
        o.right_variance = variance + sigma_disparity(seen) * sigma_disparity(seen);
      }
      result.push_back(o);
    }
    return result;
  }

  /// T_SM by some pairs, of which many may be wrong.
  std::optional<Isometry3d> first(const Pairs& pairs, const Isometry3d& start) const {
    PoseEstimatorOptions options;
    options.ransac_hypotheses = 300;
    const std::vector<PointObservation> seen = observations(pairs);
    if (static_cast<int>(seen.size()) < options_.least_agreeing) return std::nullopt;
    const PoseEstimate estimate = ransac_pose(camera_, seen, start, 1, options);
    if (estimate.inliers < options_.least_agreeing) return std::nullopt;
    return estimate.T_CW;
  }

  PoseEstimate refined(const std::vector<PointObservation>& seen, const Isometry3d& T_SM) const {
    return refine_pose(camera_, seen, {}, T_SM);
  }

  /// Of e, true T_SM = exp(e) T_SM.
  Eigen::Matrix<double, 6, 6> covariance(const std::vector<PointObservation>& seen,
                                         const PoseEstimate& estimate) const {
    const auto anchor = std::make_shared<Anchor>();
    TrackObservations observed{seen, {}};
    std::vector<Track> tracks(seen.size());
    for (std::size_t k = 0; k < seen.size(); ++k) {
      tracks[k].id = k;
      tracks[k].anchor = anchor;
      tracks[k].left = seen[k].left.cast<float>();
      observed.index.push_back(static_cast<int>(k));
    }
    PoseDrift drift(calibration_covariance(options_.calibration, prior_.disparity_offset_sigma));
    drift.begin(anchor->id, PoseDrift::Matrix6d::Zero());
    const double noise = std::max(1.0, estimate.chi2_per_dof);
    return drift.measure(
        DriftMeasurement(camera_, tracks, observed, estimate, {}, options_.shared, noise)
            .of_pose());
  }

 private:
  double disparity(const StereoView::Point& p) const {
    return std::max(0.1, p.disparity + prior_.disparity_offset);
  }
  double sigma_disparity(const StereoView::Point& p) const {
    return std::hypot(options_.sigma_disparity, p.sigma_disparity);
  }

  const StereoCamera& camera_;
  const StereoView& made_;
  const StereoView& seen_;
  const ViewPrior& prior_;
  const ViewAlignmentOptions& options_;
  std::vector<Vector3d> points_;  // of made_; at the origin: it has no depth
};

}  // namespace

std::optional<ViewAlignment> align_views(const StereoCamera& camera, const StereoView& a,
                                         const StereoView& b, const ViewPrior& prior,
                                         const ViewAlignmentOptions& options) {
  constexpr double kExpected = 25.0, kFound = 14.0, kNearer = 7.0,
                   kFine = 4.0;  // [px of the level]
  const Likeness likeness(a, b);
  const Way forth(camera, a, b, prior, options), back(camera, b, a, prior, options);
  const auto bits = [&](int i, int j) { return likeness.bits(i, j); };
  const auto bits_back = [&](int j, int i) { return likeness.bits(i, j); };
  const Isometry3d start = prior.b_in_a ? prior.b_in_a->inverse() : Isometry3d::Identity();  // T_ba

  std::optional<Isometry3d> T_ba = forth.first(likeness.clear(options), start);
  if (!T_ba && prior.b_in_a) T_ba = forth.first(forth.near(start, kExpected, bits), start);
  if (!T_ba) return std::nullopt;

  std::vector<PointObservation> seen;
  PoseEstimate b_in_a;
  for (const double radius : {kFound, kNearer, kFine}) {
    seen = forth.observations(forth.near(*T_ba, radius, bits));
    b_in_a = forth.refined(seen, *T_ba);
    if (!b_in_a.solved) return std::nullopt;
    T_ba = b_in_a.T_CW;
  }
  if (b_in_a.inliers < options.least_inliers) return std::nullopt;
  const std::vector<PointObservation> seen_back =
      back.observations(back.near(T_ba->inverse(), kFine, bits_back));
  const PoseEstimate a_in_b = back.refined(seen_back, T_ba->inverse());
  if (!a_in_b.solved || a_in_b.inliers < options.least_inliers) return std::nullopt;
  const Isometry3d apart = b_in_a.T_CW * a_in_b.T_CW;
  if (apart.translation().norm() > options.most_apart ||
      Eigen::AngleAxisd(apart.linear()).angle() > options.most_turned) {
    return std::nullopt;
  }
  // The estimate's error is exp(e) on T_ba, so exp(-e) on T_ab from the right.
  ViewAlignment result;
  result.measured.T = b_in_a.T_CW.inverse();
  Eigen::Matrix<double, 6, 6> covariance = forth.covariance(seen, b_in_a);
  const Eigen::Matrix<double, 6, 6> Ad = adjoint(b_in_a.T_CW);
  const Eigen::Matrix<double, 6, 6> of_both =
      covariance + Ad * back.covariance(seen_back, a_in_b) * Ad.transpose();
  const Eigen::Matrix<double, 6, 1> differ = log_se3(apart);
  covariance *= std::max(1.0, differ.dot(of_both.ldlt().solve(differ)) / 6.0);
  if (covariance.topLeftCorner<3, 3>().trace() > options.most_unsure * options.most_unsure ||
      covariance.bottomRightCorner<3, 3>().trace() >
          options.most_unsure_turn * options.most_unsure_turn) {
    return std::nullopt;
  }
  result.measured.information = covariance.inverse();
  result.measured.information =
      0.5 * (result.measured.information + result.measured.information.transpose()).eval();
  result.inliers = std::min(b_in_a.inliers, a_in_b.inliers);
  if (!is_information(result.measured.information)) return std::nullopt;
  return result;
}

}  // namespace prospect
