// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/track.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace prospect {

using Eigen::Isometry3d;
using Eigen::Matrix2d;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

std::optional<TrackPrediction> predict_track(const Track& track, const Isometry3d& T_CW,
                                             const StereoCamera& stereo, double max_scale) {
  const PinholeCamera& camera = stereo.left;
  const Vector3d Y = T_CW * track.position;
  if (!(Y.z() > 0.1)) return {};
  const Vector2d p = camera.project(Y);
  if (!(p.x() >= 0 && p.y() >= 0 && p.x() <= camera.width - 1 && p.y() <= camera.height - 1)) {
    return {};
  }
  const Matrix3d R = (T_CW * track.anchor->T_CW.inverse()).linear();
  const Vector3d& X = track.in_anchor;
  const Vector2d slope = track.slope * X.z() / (camera.fx * stereo.baseline);  // g / d
  Eigen::Matrix<double, 3, 2> tangents;
  tangents.col(0) = R * (X.z() / camera.fx * Vector3d::UnitX() - slope.x() * X);
  tangents.col(1) = R * (X.z() / camera.fy * Vector3d::UnitY() - slope.y() * X);
  const Matrix2d B = camera.projection_jacobian(Y) * tangents;
  const Matrix2d B_right =
      camera.projection_jacobian(Y - stereo.baseline * Vector3d::UnitX()) * tangents;
  const double determinant = B.determinant();
  const double limit = max_scale * max_scale;
  if (!(determinant < limit && determinant > 1.0 / limit)) return {};
  return TrackPrediction{p.cast<float>(), B.inverse().cast<float>(),
                         B_right.inverse().cast<float>()};
}

bool in_full_view(const Track& track, const Isometry3d& T_CW, const StereoCamera& stereo,
                  double max_scale) {
  constexpr double kBorder = 12.0;  // [px]: half a patch, its gradient, and what it may move
  const double limit = 0.875 * max_scale;
  const auto predicted = predict_track(track, T_CW, stereo, max_scale);
  if (!predicted) return false;
  const double scale = std::sqrt(1.0 / predicted->A.determinant());
  return scale < limit && scale > 1.0 / limit && predicted->pixel.x() >= kBorder &&
         predicted->pixel.y() >= kBorder &&
         predicted->pixel.x() <= stereo.left.width - 1 - kBorder &&
         predicted->pixel.y() <= stereo.left.height - 1 - kBorder;
}

void place_track(Track& track, const StereoCamera& camera, double offset) {
  const double d = std::max(track.disparity + offset, 0.1);
  const double u = track.pixel.x(), v = track.pixel.y();
  const Matrix3d R = track.anchor->T_CW.linear().transpose();
  track.in_anchor = camera.triangulate(u, v, d);
  track.position = track.anchor->T_CW.inverse() * track.in_anchor;
  StereoCamera measured = camera;
  measured.sigma_d = std::sqrt(camera.sigma_d * camera.sigma_d + track.disparity_variance);
  track.covariance = R * measured.triangulation_covariance(u, v, d) * R.transpose();
}

TrackObservations observe_tracks(const std::vector<Track>& tracks, const Vector3d& sigma,
                                 double offset) {
  std::vector<int> index;
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    if (tracks[i].tracked && !tracks[i].moving) index.push_back(static_cast<int>(i));
  }
  return observe_tracks(tracks, std::move(index), sigma, offset);
}

TrackObservations observe_tracks(const std::vector<Track>& tracks, std::vector<int> index,
                                 const Vector3d& sigma, double offset) {
  TrackObservations out;
  out.index = std::move(index);
  for (const int i : out.index) {
    const Track& t = tracks[static_cast<std::size_t>(i)];
    PointObservation o;
    o.T_WA = t.anchor->T_CW.inverse();
    o.measured << t.pixel.x(), t.pixel.y(), std::max(t.disparity + offset, 0.1);
    o.sigma = sigma;
    o.sigma.z() = std::sqrt(sigma.z() * sigma.z() + t.disparity_variance);
    o.left = t.left.cast<double>();
    o.left_covariance = t.left_covariance;
    if (t.has_right) {
      o.right = t.right - offset;
      o.right_variance = t.right_variance;
    }
    out.seen.push_back(o);
  }
  return out;
}

std::optional<double> image_flow(const StereoCamera& camera, const Vector3d& position,
                                 const Eigen::Isometry3d& from_T_CW,
                                 const Eigen::Isometry3d& to_T_CW) {
  const Vector3d was = from_T_CW * position, is = to_T_CW * position;
  if (!(was.z() > 0.1 && is.z() > 0.1)) return std::nullopt;
  return (camera.left.project(is) - camera.left.project(was)).norm();
}

}  // namespace prospect
