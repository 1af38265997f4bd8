#pragma once

#include <Eigen/Geometry>
#include <array>
#include <memory>

#include "models/camera.h"
#include "perception/image.h"

namespace prospect {

/// One camera as calibrated: pinhole with radial-tangential distortion (k1, k2, p1, p2; Brown
/// 1966). With (x, y) = (X/Z, Y/Z) and s = x^2 + y^2:
///   x' = x (1 + k1 s + k2 s^2) + 2 p1 x y + p2 (s + 2 x^2),
///   y' = y (1 + k1 s + k2 s^2) + p1 (s + 2 y^2) + 2 p2 x y,     u = fx x' + cx, v = fy y' + cy.
struct CalibratedCamera {
  PinholeCamera pinhole;
  std::array<double, 4> distortion = {0.0, 0.0, 0.0, 0.0};
  Eigen::Isometry3d T_BC = Eigen::Isometry3d::Identity();  ///< camera to body
};

/// Image of the ray (x, y, 1), distorted [px].
Eigen::Vector2d project_distorted(const CalibratedCamera& camera, const Eigen::Vector2d& ray);
/// Its inverse, by iteration; the ray that pixel p shows.
Eigen::Vector2d undistort(const CalibratedCamera& camera, const Eigen::Vector2d& p);

/// Makes of an arbitrary stereo pair a rectified one: a common orientation whose x axis is the
/// baseline and whose z axis is the mean of both cameras' (Fusiello, Trucco, Verri 2000), one focal
/// length and principal point, no distortion. These are chosen as the widest view in which every
/// pixel of both images has a source, so there are no black borders with corners of their own.
class Rectification {
 public:
  /// Throws std::invalid_argument, in words, if the right camera is not to the right of the left
  /// one (exchanged, or turned by more than 30 degrees from the baseline's normal), if sizes
  /// differ, or if no common view is left.
  Rectification(const CalibratedCamera& left, const CalibratedCamera& right);
  ~Rectification();
  Rectification(Rectification&&) noexcept;
  Rectification& operator=(Rectification&&) noexcept;

  const StereoCamera& camera() const { return camera_; }   ///< of the rectified pair
  const Eigen::Isometry3d& T_BC() const { return T_BC_; }  ///< rectified left camera to body
  /// Rectified images; bilinear. The caller has checked the sizes.
  Image left(const ImageView& image) const;
  Image right(const ImageView& image) const;

 private:
  struct Maps;
  StereoCamera camera_;
  Eigen::Isometry3d T_BC_ = Eigen::Isometry3d::Identity();
  std::unique_ptr<Maps> maps_;
};

}  // namespace prospect
