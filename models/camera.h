// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace prospect {

class Knobs;

/// Ideal pinhole camera. Frame C: x right, y down, z forward. Pixels: u right, v down, [px].
///   u = cx + fx X/Z,  v = cy + fy Y/Z.   Valid image: 0 <= u <= width, 0 <= v <= height.
struct PinholeCamera {
  double fx = 450.0, fy = 450.0, cx = 320.0, cy = 240.0;
  double width = 640.0, height = 480.0;

  /// Projection p = Pi(Y) of a point Y in C [m]; requires Y.z() > 0 (asserted).
  Eigen::Vector2d project(const Eigen::Vector3d& Y) const;
  /// dPi/dY, 2 x 3 [px/m]; requires Y.z() > 0.
  Eigen::Matrix<double, 2, 3> projection_jacobian(const Eigen::Vector3d& Y) const;
  /// Whether a pixel lies in the valid image, borders included.
  bool in_image(const Eigen::Vector2d& p) const;
  double horizontal_fov() const;  ///< atan(cx/fx) + atan((width - cx)/fx) [rad]
  double vertical_fov() const;    ///< atan(cy/fy) + atan((height - cy)/fy) [rad]
};

/// Rectified stereo rig: right camera displaced by `baseline` along C's x axis.
///   disparity d = fx baseline / Z = u_left - u_right > 0.
struct StereoCamera {
  PinholeCamera left = {};
  double baseline = 0.12;  ///< b [m]
  double sigma_u = 0.5;    ///< image noise [px], one standard deviation
  double sigma_v = 0.5;
  double sigma_d = 0.3;  ///< disparity noise [px]

  /// (u, v, d) of a point Y in C; requires Y.z() > 0 (asserted). Inverse of triangulate().
  Eigen::Vector3d project(const Eigen::Vector3d& Y) const;
  /// Eq. (1): Y = (b/d) (u - cx, (fx/fy)(v - cy), fx); requires d > 0.
  Eigen::Vector3d triangulate(double u, double v, double d) const;
  /// J = dY/d(u, v, d), 3 x 3.
  Eigen::Matrix3d triangulation_jacobian(double u, double v, double d) const;
  /// Sigma_Y = J diag(sigma_u^2, sigma_v^2, sigma_d^2) J^T [m^2], in C.
  Eigen::Matrix3d triangulation_covariance(double u, double v, double d) const;
};

/// What a depth sensor resolves: |azimuth| <= horizontal_fov/2, |elevation| <= vertical_fov/2,
/// min_range <= range <= max_range, unoccluded. A depth camera, or a lidar: up to all round.
struct RgbdFootprint {
  double horizontal_fov = 1.22;  ///< [rad], up to 2 pi
  double vertical_fov = 0.95;    ///< [rad], up to pi; 0: a single layer of rays
  double min_range = 0.3;        ///< [m]
  double max_range = 4.0;        ///< [m]
};

/// Where a camera sits on the robot: T_BC maps camera coordinates to body coordinates.
/// The default looks along B's x axis from 0.45 m above B's origin (B's origin on the floor).
struct CameraMount {
  Eigen::Isometry3d T_BC = forward_facing({0.0, 0.0, 0.45});

  /// Camera at `position` in B [m], optical axis turned by `yaw` from B's x axis and `pitch` down,
  /// the camera by `roll` about it, clockwise as it looks [rad].
  static Eigen::Isometry3d forward_facing(const Eigen::Vector3d& position, double yaw = 0.0,
                                          double pitch = 0.0, double roll = 0.0);
};

/// The angles with which forward_facing() gives the mount [rad].
/// |yaw|, |roll| <= pi, |pitch| <= pi/2.
/// Of a vertical axis there are many such yaws and rolls; one pair is given.
struct MountAngles {
  double yaw = 0.0, pitch = 0.0, roll = 0.0;
};
MountAngles angles(const CameraMount& mount);

/// The knobs (models/knobs.h): all of them.
void describe(Knobs& knobs, PinholeCamera& camera);
void describe(Knobs& knobs, StereoCamera& camera);
void describe(Knobs& knobs, RgbdFootprint& footprint);

/// Throw std::invalid_argument naming the entry, its value and what was expected. Of angles, a
/// milliradian too much is taken for rounding.
void validate(const PinholeCamera& camera);
void validate(const StereoCamera& camera);
void validate(const RgbdFootprint& footprint);
/// Refuses a T_BC that is not a finite rotation and translation.
void validate(const CameraMount& mount);

}  // namespace prospect
