// SPDX-License-Identifier: Apache-2.0
#include "perception/pipeline/depth_agreement.h"

#include <cmath>
#include <utility>

#include "perception/odometry/median.h"

namespace prospect {

using Eigen::Vector3d;

ScaleAgreement depth_agreement(const std::vector<Vector3d>& points_in_C, double relative_sigma,
                               const PinholeCamera& depth_camera, const Eigen::Isometry3d& T_CD,
                               const DepthImage& depth, const DepthAgreementOptions& options) {
  std::vector<double> samples, depths;
  const Eigen::Isometry3d T_DC = T_CD.inverse();
  for (const Vector3d& Y : points_in_C) {
    const Vector3d in_D = T_DC * Y;
    if (!depth.whole() || !Y.allFinite() || !(Y.z() > 0.0) || !(in_D.z() > 0.0)) continue;
    const Eigen::Vector2d pixel = depth_camera.project(in_D);
    // Written so that what is not finite fails.
    if (!(pixel.x() >= 1.0 && pixel.x() <= depth.width - 2.0 && pixel.y() >= 1.0 &&
          pixel.y() <= depth.height - 2.0)) {
      continue;
    }
    const int u = static_cast<int>(std::lround(pixel.x()));
    const int v = static_cast<int>(std::lround(pixel.y()));
    const double z = depth.at(u, v);
    bool smooth = options.range.holds(z);
    for (int dv = -1; dv <= 1 && smooth; ++dv) {
      for (int du = -1; du <= 1 && smooth; ++du) {
        const double near = depth.at(u + du, v + dv);
        smooth = options.range.holds(near) && std::abs(near - z) <= options.edge * z;
      }
    }
    if (!smooth) continue;
    const Vector3d X = T_CD * (z * pixel_ray(depth_camera, u, v));
    if (!(X.z() > 0.0)) continue;
    samples.push_back(std::log(Y.z() / X.z()));
    depths.push_back(Y.z());
  }
  if (samples.empty()) return {};
  return scale_agreement(std::move(samples), 0.0, relative_sigma * median(depths),
                         options.agreement);
}

}  // namespace prospect
