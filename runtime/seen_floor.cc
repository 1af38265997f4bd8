// SPDX-License-Identifier: Apache-2.0
#include "runtime/seen_floor.h"

#include "perception/mapping/ground_plane.h"

namespace prospect {

std::optional<PreflightFacts::Floor> seen_floor(const DepthImage& image,
                                                const PinholeCamera& camera,
                                                const CameraMount& mount, double base_height,
                                                const DepthRange& range) {
  constexpr double kHeightTolerance = 0.2, kTiltTolerance = 0.2;  // [m], [rad]
  Eigen::Isometry3d T_WC = mount.T_BC;
  T_WC.pretranslate(Eigen::Vector3d(0.0, 0.0, base_height));
  const GroundPrior prior = ground_prior(T_WC, kHeightTolerance, kTiltTolerance);
  GroundPlaneOptions options;
  options.range = range;
  const GroundPlane seen = find_ground(camera, image, prior, options);
  if (!seen.found) return std::nullopt;
  GroundPlane stated;
  stated.normal = prior.up;
  return PreflightFacts::Floor{prior.height,  seen.height, stated.pitch(),      seen.pitch(),
                               stated.roll(), seen.roll(), seen.sigma_height(), seen.sigma_tilt()};
}

}  // namespace prospect
