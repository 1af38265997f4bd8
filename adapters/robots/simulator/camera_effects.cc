// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/simulator/camera_effects.h"

#include "adapters/robots/simulator/hashed_draws.h"

namespace prospect {
namespace {

Eigen::Matrix3d drawn_rotation(HashedDraws& draws, double sigma) {
  // One by one: the order in which arguments are evaluated is nobody's.
  const double x = draws.normal(), y = draws.normal(), z = draws.normal();
  const Eigen::Vector3d turn = sigma * Eigen::Vector3d(x, y, z);
  if (turn.isZero(0.0)) return Eigen::Matrix3d::Identity();
  return Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
}

}  // namespace

PinholeCamera true_camera(PinholeCamera believed, const CameraEffects& effects,
                          std::uint64_t seed) {
  HashedDraws draws(seed);
  const double focal = 1.0 + effects.focal_length * draws.normal();
  believed.fx *= focal;
  believed.fy *= focal;
  believed.cx += effects.principal_point * draws.normal();
  believed.cy += effects.principal_point * draws.normal();
  return believed;
}

TrueStereo true_stereo(const StereoCamera& believed, const CameraEffects& effects,
                       std::uint64_t seed) {
  TrueStereo stereo{true_camera(believed.left, effects, seed), Eigen::Isometry3d::Identity()};
  HashedDraws draws(mixed_bits(seed));
  const double length = 1.0 + effects.baseline * draws.normal();
  stereo.T_LR.translation().x() = believed.baseline * length;
  stereo.T_LR.linear() = drawn_rotation(draws, effects.rotation);
  return stereo;
}

CameraMount true_mount(CameraMount believed, const CameraEffects& effects, std::uint64_t seed) {
  HashedDraws draws(seed);
  const Eigen::Matrix3d turn = drawn_rotation(draws, effects.mount);
  if (effects.mount != 0.0) believed.T_BC.linear() *= turn;
  return believed;
}

}  // namespace prospect
