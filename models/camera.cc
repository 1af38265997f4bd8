// SPDX-License-Identifier: Apache-2.0
#include "models/camera.h"

#include <cassert>
#include <cmath>
#include <numbers>

#include "models/knobs.h"
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
                                              double pitch, double roll) {
  const double cy = std::cos(yaw), sy = std::sin(yaw);
  const double cp = std::cos(pitch), sp = std::sin(pitch);
  Eigen::Isometry3d T_BC = Eigen::Isometry3d::Identity();
  // Columns: C's x (right), y (down) and z (forward) axes seen from B.
  T_BC.linear() << sy, -sp * cy, cp * cy,  //
      -cy, -sp * sy, cp * sy,              //
      0.0, -cp, -sp;
  T_BC.linear() *= Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  T_BC.translation() = position;
  return T_BC;
}

MountAngles angles(const CameraMount& mount) {
  const Eigen::Matrix3d R = mount.T_BC.linear();
  const Eigen::Vector3d axis = R.col(2);
  MountAngles out;
  out.yaw = std::atan2(axis.y(), axis.x());
  out.pitch = std::atan2(-axis.z(), std::hypot(axis.x(), axis.y()));
  // What is left is a turn about z of C, whatever the yaw of a vertical axis.
  const Eigen::Matrix3d left =
      CameraMount::forward_facing(Eigen::Vector3d::Zero(), out.yaw, out.pitch)
          .linear()
          .transpose() *
      R;
  out.roll = std::atan2(left(1, 0), left(0, 0));
  return out;
}

void describe(Knobs& knobs, PinholeCamera& c) {
  knobs.number("fx", c.fx, {1.0, 1e5}, "px", "focal length");
  knobs.number("fy", c.fy, {1.0, 1e5}, "px", "focal length");
  knobs.number("cx", c.cx, {0.0, 1e5}, "px", "principal point");
  knobs.number("cy", c.cy, {0.0, 1e5}, "px", "principal point");
  knobs.number("width", c.width, {1.0, 1e5}, "px", "image width");
  knobs.number("height", c.height, {1.0, 1e5}, "px", "image height");
  knobs.require(c.cx <= c.width, "cx", "cx > width; expected at most width");
  knobs.require(c.cy <= c.height, "cy", "cy > height; expected at most height");
}

void describe(Knobs& knobs, StereoCamera& c) {
  describe(knobs, c.left);
  knobs.number("baseline", c.baseline, {0.001, 10.0}, "m", "distance of the two cameras");
  knobs.number("sigma_u", c.sigma_u, {0.01, 50.0}, "px", "image noise");
  knobs.number("sigma_v", c.sigma_v, {0.01, 50.0}, "px", "image noise");
  knobs.number("sigma_d", c.sigma_d, {0.01, 50.0}, "px", "disparity noise");
}

void describe(Knobs& knobs, RgbdFootprint& f) {
  knobs.degrees("horizontal_fov", f.horizontal_fov, {1.0, 360.0}, "horizontal field of view");
  knobs.degrees("vertical_fov", f.vertical_fov, {0.0, 180.0},
                "vertical field of view; 0: a single layer of rays");
  knobs.number("min_range", f.min_range, {0.0, 100.0}, "m", "nearest measured range");
  knobs.number("max_range", f.max_range, {0.5, 1000.0}, "m", "farthest measured range");
  knobs.require(f.max_range > f.min_range, "max_range", "max_range <= min_range; expected more");
}

void validate(const PinholeCamera& camera) { check_knobs("camera", camera); }
void validate(const StereoCamera& camera) { check_knobs("stereo camera", camera); }
void validate(const RgbdFootprint& footprint) { check_knobs("depth sensor", footprint); }

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
