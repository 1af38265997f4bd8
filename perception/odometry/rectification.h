// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <memory>

#include "models/camera.h"
#include "models/image.h"

namespace prospect {

enum class Lens {
  kRadialTangential,  ///< Brown 1966, with OpenCV's rational terms
  kEquidistant        ///< fisheye, Kannala and Brandt 2006
};

/// One camera as calibrated: pinhole with distortion, u = fx x' + cx, v = fy y' + cy. With
/// (x, y) = (X/Z, Y/Z) and s = x^2 + y^2, radial-tangential (k1, k2, p1, p2, k3, k4, k5, k6):
///   r  = (1 + k1 s + k2 s^2 + k3 s^3) / (1 + k4 s + k5 s^2 + k6 s^3),
///   x' = x r + 2 p1 x y + p2 (s + 2 x^2),     y' = y r + p1 (s + 2 y^2) + 2 p2 x y;
/// equidistant (k1, k2, k3, k4), with t = atan(sqrt(s)):
///   (x', y') = (x, y) / sqrt(s) * t (1 + k1 t^2 + k2 t^4 + k3 t^6 + k4 t^8).
struct CalibratedCamera {
  PinholeCamera pinhole;
  Lens lens = Lens::kRadialTangential;
  std::array<double, 8> distortion = {};
  /// Camera to a body B that is common to both: the left camera itself, if its T_BC is the
  /// identity; then the right one's is the pose of the right camera in the left one.
  Eigen::Isometry3d T_BC = Eigen::Isometry3d::Identity();
};

/// Image of the ray (x, y, 1), distorted [px].
Eigen::Vector2d project_distorted(const CalibratedCamera& camera, const Eigen::Vector2d& ray);
/// Its inverse, by iteration; the ray that pixel p shows. NaN where a fisheye looks 85 degrees or
/// more aside, which no ray (x, y, 1) describes well.
Eigen::Vector2d undistort(const CalibratedCamera& camera, const Eigen::Vector2d& p);

/// Makes of an arbitrary stereo pair a rectified one: a common orientation whose x axis is the
/// baseline and whose z axis is the mean of both cameras' (Fusiello, Trucco, Verri 2000), one focal
/// length and principal point, no distortion. These are chosen as the widest view in which every
/// pixel of both images has a source, so there are no black borders with corners of their own; of
/// fisheyes at most 100 degrees each way, as a wider flat image is mostly stretched border.
///
/// Thread-safety: immutable, concurrent calls are safe. Deterministic.
class Rectification {
 public:
  /// Throws std::invalid_argument, in words, if a camera's numbers are out of range, if the right
  /// camera is not to the right of the left one (exchanged, or turned by more than 30 degrees from
  /// the baseline's normal), if sizes differ, or if no common view is left.
  Rectification(const CalibratedCamera& left, const CalibratedCamera& right);
  ~Rectification();
  Rectification(Rectification&&) noexcept;
  Rectification& operator=(Rectification&&) noexcept;

  const StereoCamera& camera() const { return camera_; }   ///< of the rectified pair
  const Eigen::Isometry3d& T_BC() const { return T_BC_; }  ///< rectified left camera to body

  /// Rectified images, of the same size; bilinear. Throw std::invalid_argument if an image has not
  /// the size that its camera was calibrated for.
  Image left(const ImageView& image) const;
  Image right(const ImageView& image) const;
  ImagePair pair(const ImageView& left_image, const ImageView& right_image) const {
    return {left(left_image), right(right_image)};
  }

 private:
  struct Maps;
  StereoCamera camera_;
  Eigen::Isometry3d T_BC_ = Eigen::Isometry3d::Identity();
  std::unique_ptr<Maps> maps_;
};

}  // namespace prospect
