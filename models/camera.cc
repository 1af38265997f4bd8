#include "models/camera.h"

#include <cassert>
#include <cmath>
#include <numbers>

#include "models/parameter_check.h"

namespace prospect {

Eigen::Vector2d PinholeCamera::project(const Eigen::Vector3d& Y) const {
  assert(Y.z() > 0.0);
  return {cx + fx * Y.x() / Y.z(), cy + fy * Y.y() / Y.z()};
}

Eigen::Matrix<double, 2, 3> PinholeCamera::projection_jacobian(const Eigen::Vector3d& Y) const {
  assert(Y.z() > 0.0);
  const double inverse = 1.0 / Y.z();
  Eigen::Matrix<double, 2, 3> J;
  J << fx * inverse, 0.0, -fx * Y.x() * inverse * inverse,  //
      0.0, fy * inverse, -fy * Y.y() * inverse * inverse;
  return J;
}

bool PinholeCamera::in_image(const Eigen::Vector2d& p) const {
  return p.x() >= 0.0 && p.x() <= width && p.y() >= 0.0 && p.y() <= height;
}

double PinholeCamera::horizontal_fov() const {
  return std::atan(cx / fx) + std::atan((width - cx) / fx);
}

double PinholeCamera::vertical_fov() const {
  return std::atan(cy / fy) + std::atan((height - cy) / fy);
}

Eigen::Vector3d StereoCamera::project(const Eigen::Vector3d& Y) const {
  const Eigen::Vector2d p = left.project(Y);
  return {p.x(), p.y(), left.fx * baseline / Y.z()};
}

Eigen::Vector3d StereoCamera::triangulate(double u, double v, double d) const {
  assert(d > 0.0);
  return baseline / d * Eigen::Vector3d(u - left.cx, left.fx / left.fy * (v - left.cy), left.fx);
}

Eigen::Matrix3d StereoCamera::triangulation_jacobian(double u, double v, double d) const {
  assert(d > 0.0);
  const double scale = baseline / d;
  const Eigen::Vector3d Y = triangulate(u, v, d);
  Eigen::Matrix3d J;
  J << scale, 0.0, -Y.x() / d,                     //
      0.0, scale * left.fx / left.fy, -Y.y() / d,  //
      0.0, 0.0, -Y.z() / d;
  return J;
}

Eigen::Matrix3d StereoCamera::triangulation_covariance(double u, double v, double d) const {
  const Eigen::Matrix3d J = triangulation_jacobian(u, v, d);
  const Eigen::Vector3d variances(sigma_u * sigma_u, sigma_v * sigma_v, sigma_d * sigma_d);
  return J * variances.asDiagonal() * J.transpose();
}

Eigen::Isometry3d CameraMount::forward_facing(const Eigen::Vector3d& position, double yaw,
                                              double pitch) {
  const double cy = std::cos(yaw), sy = std::sin(yaw);
  const double cp = std::cos(pitch), sp = std::sin(pitch);
  Eigen::Isometry3d T_BC = Eigen::Isometry3d::Identity();
  // Columns: C's x (right), y (down) and z (forward) axes seen from B.
  T_BC.linear() << sy, -sp * cy, cp * cy,  //
      -cy, -sp * sy, cp * sy,              //
      0.0, -cp, -sp;
  T_BC.translation() = position;
  return T_BC;
}

void validate(const PinholeCamera& camera) {
  constexpr std::string_view kOwner = "camera";
  check_positive(kOwner, "fx", camera.fx);
  check_positive(kOwner, "fy", camera.fy);
  check_positive(kOwner, "width", camera.width);
  check_positive(kOwner, "height", camera.height);
  check_parameter(camera.cx >= 0.0 && camera.cx <= camera.width, kOwner, "cx", camera.cx,
                  "a number in [0, width]");
  check_parameter(camera.cy >= 0.0 && camera.cy <= camera.height, kOwner, "cy", camera.cy,
                  "a number in [0, height]");
}

void validate(const StereoCamera& camera) {
  validate(camera.left);
  constexpr std::string_view kOwner = "stereo camera";
  check_positive(kOwner, "baseline", camera.baseline);
  check_positive(kOwner, "sigma_u", camera.sigma_u);
  check_positive(kOwner, "sigma_v", camera.sigma_v);
  check_positive(kOwner, "sigma_d", camera.sigma_d);
}

void validate(const RgbdFootprint& footprint) {
  constexpr std::string_view kOwner = "depth sensor";
  constexpr double kRounding = 1e-3;  // [rad]: 6.2832 is meant to be all round
  check_parameter(footprint.horizontal_fov > 0.0 &&
                      footprint.horizontal_fov <= 2.0 * std::numbers::pi + kRounding,
                  kOwner, "horizontal_fov", footprint.horizontal_fov,
                  "an angle above 0, up to 2 pi rad");
  check_parameter(
      footprint.vertical_fov >= 0.0 && footprint.vertical_fov <= std::numbers::pi + kRounding,
      kOwner, "vertical_fov", footprint.vertical_fov, "an angle from 0 to pi rad");
  check_not_negative(kOwner, "min_range", footprint.min_range);
  check_parameter(std::isfinite(footprint.max_range) && footprint.max_range > footprint.min_range,
                  kOwner, "max_range", footprint.max_range,
                  "a finite number greater than min_range");
}

void validate(const CameraMount& mount) {
  constexpr std::string_view kOwner = "camera mount";
  const Eigen::Matrix3d& R = mount.T_BC.linear();
  for (int i = 0; i < 3; ++i) check_finite(kOwner, "position", mount.T_BC.translation()[i]);
  const double error = (R.transpose() * R - Eigen::Matrix3d::Identity()).norm();  // NaN stays NaN
  check_parameter(error <= 1e-6, kOwner, "deviation of the rotation from an orthonormal matrix",
                  error, "at most 1e-6");
  check_parameter(R.determinant() > 0.0, kOwner, "determinant of the rotation", R.determinant(),
                  "+1 (right-handed)");
}

}  // namespace prospect
