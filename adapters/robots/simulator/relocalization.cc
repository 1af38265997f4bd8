// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/simulator/relocalization.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

#include "adapters/robots/simulator/depth_camera.h"
#include "engine/support/cholesky.h"

namespace prospect {
namespace {

struct Match {
  Eigen::Vector2d body, map;
  Eigen::Matrix2d body_covariance, map_covariance;
};

}  // namespace

std::optional<FoundPose> relocalize(const std::vector<FeatureObservation>& observations,
                                    const std::function<const Landmark*(std::uint32_t)>& find,
                                    const StereoCamera& stereo, const CameraMount& mount,
                                    const Pose& guess, const Eigen::Matrix3d& Omega, int least) {
  constexpr double kScale = 1.5, kViewChange = 0.5, kSlack = 0.02, kHuber = 1.5, kAgrees = 3.0;
  constexpr double kPlausible = 16.27;  // 99.9 % of chi-squared with 3 degrees of freedom
  const Eigen::Vector3d eye = camera_pose(guess, mount).translation();
  const Eigen::Matrix3d R_BC = mount.T_BC.linear();
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
    const Eigen::Matrix3d covariance =
        R_BC * stereo.triangulation_covariance(o.u, o.v, o.disparity) * R_BC.transpose();
    matches.push_back({p.head<2>(), l->position.head<2>(), covariance.topLeftCorner<2, 2>(),
                       l->covariance.topLeftCorner<2, 2>()});
  }
  if (static_cast<int>(matches.size()) < least) return std::nullopt;

  Eigen::Vector3d offset = Eigen::Vector3d::Zero();  // xi - xi_0
  Eigen::Matrix3d H = Omega;
  int agreeing = 0;
  constexpr int kIterations = 20;
  for (int iteration = 0; iteration <= kIterations; ++iteration) {
    const Eigen::Matrix2d R = Eigen::Rotation2Dd(guess.yaw + offset[2]).toRotationMatrix();
    const Eigen::Vector2d shift = guess.position.head<2>() + offset.head<2>();
    H = Omega;
    Eigen::Vector3d g = Omega * offset;
    agreeing = 0;
    for (const Match& m : matches) {
      const Eigen::Vector2d arm = R * m.body;
      const Eigen::Vector2d r = arm + shift - m.map;
      const Eigen::Matrix2d S = R * m.body_covariance * R.transpose() + m.map_covariance +
                                kSlack * kSlack * Eigen::Matrix2d::Identity();
      const Eigen::Matrix2d information = S.inverse();
      const double distance = std::sqrt(r.dot(information * r));
      agreeing += distance <= kAgrees;
      const double weight = distance > kHuber ? kHuber / distance : 1.0;
      Eigen::Matrix<double, 2, 3> J;
      J << 1.0, 0.0, -arm.y(), 0.0, 1.0, arm.x();
      H += weight * J.transpose() * information * J;
      g += weight * J.transpose() * information * r;
    }
    if (iteration == kIterations) break;
    const Eigen::Vector3d step = H.ldlt().solve(Eigen::Vector3d(-g));
    if (!step.allFinite()) return std::nullopt;
    offset += step;
  }
  if (agreeing < least || offset.dot(Omega * offset) > kPlausible) return std::nullopt;
  FoundPose found{guess, H.inverse()};
  if (!found.covariance.allFinite()) return std::nullopt;
  found.pose.position.head<2>() += offset.head<2>();
  found.pose.yaw += offset[2];
  return found;
}

}  // namespace prospect
