#include "adapters/simulator/relocalization.h"

#include <Eigen/Geometry>
#include <cmath>

#include "adapters/simulator/depth_camera.h"

namespace prospect {
namespace {

struct Match {
  Eigen::Vector2d body, map;
  double variance;
  double weight;
};

}  // namespace

std::optional<Pose> relocalize(const std::vector<FeatureObservation>& observations,
                               const std::function<const Landmark*(std::uint32_t)>& find,
                               const StereoCamera& stereo, const CameraMount& mount,
                               const Pose& guess, int least) {
  constexpr double kScale = 1.5, kViewChange = 0.5, kSlack = 0.02;
  const Eigen::Vector3d eye = camera_pose(guess, mount).translation();
  std::vector<Match> matches;
  for (const FeatureObservation& o : observations) {
    const Landmark* l = find(o.feature);
    if (l == nullptr || !(o.disparity > 0.0)) continue;
    const Eigen::Vector3d to_eye = eye - l->position;
    const double range = to_eye.norm();
    if (!(range > 0.0) || range > kScale * l->creation_range ||
        l->creation_range > kScale * range ||
        to_eye.dot(l->creation_direction) < std::cos(kViewChange) * range) {
      continue;
    }
    const Eigen::Vector3d p = mount.T_BC * stereo.triangulate(o.u, o.v, o.disparity);
    const double variance =
        stereo.triangulation_covariance(o.u, o.v, o.disparity).trace() + l->covariance.trace();
    matches.push_back({p.head<2>(), l->position.head<2>(), variance, 1.0 / variance});
  }
  if (static_cast<int>(matches.size()) < least) return std::nullopt;

  double yaw = 0.0;
  Eigen::Vector2d shift = Eigen::Vector2d::Zero();
  int agreeing = 0;
  for (int iteration = 0; iteration < 8; ++iteration) {
    double total = 0.0;
    Eigen::Vector2d body = Eigen::Vector2d::Zero(), map = Eigen::Vector2d::Zero();
    for (const Match& m : matches) {
      total += m.weight;
      body += m.weight * m.body;
      map += m.weight * m.map;
    }
    body /= total;
    map /= total;
    double cross = 0.0, dot = 0.0;
    for (const Match& m : matches) {
      const Eigen::Vector2d b = m.body - body, w = m.map - map;
      cross += m.weight * (b.x() * w.y() - b.y() * w.x());
      dot += m.weight * b.dot(w);
    }
    yaw = std::atan2(cross, dot);
    const Eigen::Rotation2Dd R(yaw);
    shift = map - R * body;
    agreeing = 0;
    for (Match& m : matches) {
      const double sigma = std::sqrt(m.variance);
      const double residual = (R * m.body + shift - m.map).norm();
      const double huber = 1.5 * sigma + kSlack;
      m.weight = (residual > huber ? huber / residual : 1.0) / m.variance;
      agreeing += residual <= 3.0 * sigma + kSlack;
    }
  }
  if (agreeing < least) return std::nullopt;
  Pose pose = guess;
  pose.position.head<2>() = shift;
  // The yaw stays continuous along the mission.
  pose.yaw = guess.yaw + std::remainder(yaw - guess.yaw, 2.0 * M_PI);
  return pose;
}

}  // namespace prospect
