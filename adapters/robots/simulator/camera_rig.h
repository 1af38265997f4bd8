// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>

#include "adapters/robots/simulator/scene_renderer.h"
#include "models/camera.h"
#include "models/image.h"
#include "models/types.h"
#include "perception/mapping/depth_image.h"

namespace prospect {

class Knobs;

struct CameraRigOptions {
  StereoCamera stereo;
  CameraMount stereo_mount;  ///< of the left camera

  RgbdFootprint footprint;
  int depth_width = 640, depth_height = 480;  ///< [px]
  CameraMount depth_mount;

  // The grey images, in this order.
  double exposure = 1.0;       ///< gain on the grey levels; they are cut at 255
  double vignetting = 0.1;     ///< share of light lost in the image's corners, growing with r^2
  double blur = 0.5;           ///< [px] standard deviation of the lens' Gaussian
  double exposure_time = 0.0;  ///< [s] motion blur: see CameraRig
  double read_noise = 1.5;     ///< [grey levels] one standard deviation in the dark
  double shot_noise = 0.02;    ///< variance a grey level [grey levels]

  // Depth.
  double depth_noise_constant = 0.0015;  ///< sigma = constant + quadratic z^2 [m; 1/m]
  double depth_noise_quadratic = 0.0016;
  double depth_dropout = 0.02;  ///< probability that a pixel measures nothing
  double max_incidence = 1.4;   ///< [rad] between ray and surface normal; beyond: nothing

  int threads = 1;
  std::uint64_t seed = 1;
};

/// The knobs (models/knobs.h); cameras, depth noise and seed are the simulator's.
void describe(Knobs& knobs, CameraRigOptions& options);

/// Whether an image in perspective holds it: 1 to 170 degrees wide and high.
bool is_rendered(const RgbdFootprint& footprint);

/// Pinhole camera of width x height pixels that sees the footprint's field of view:
///   fx = (width / 2) / tan(horizontal_fov / 2),  cx = (width - 1) / 2;  likewise fy, cy.
PinholeCamera depth_camera(const RgbdFootprint& footprint, int width, int height);

/// The cameras of the robot in a textured scene: a rectified stereo pair and a depth camera, with
/// what is imperfect in real ones.
///
/// Grey images: the renderer's grey x exposure x vignetting; the lens' blur; motion blur, a box
/// along the rows of fx |yaw_rate| exposure_time pixels, which is the flow of far points while the
/// body turns (what its translation adds is left out); Gaussian noise of variance read_noise^2 +
/// shot_noise x grey; rounded.
/// Depth: z of the pixel's own ray, plus noise; NaN by drop-out, where the range along the ray is
/// outside the footprint's, where the surface is met at a grazing angle, and where there is none.
///
/// Noise is a function of (seed, frame, camera, pixel) alone - a hash, four of its bytes summed for
/// a Gaussian of at most 3.5 sigma -, so images do not depend on which were taken before, and the
/// bits not on the number of threads. Immutable: concurrent calls are safe.
class CameraRig {
 public:
  /// Throws std::invalid_argument on options out of range, or without a renderer.
  CameraRig(std::shared_ptr<const SceneRenderer> scene, const CameraRigOptions& options);

  /// The pair of frame number `frame`, from the true pose of the body that moves with `twist`.
  ImagePair stereo(const Pose& true_pose, const Twist& twist, std::uint64_t frame) const;
  DepthImage depth(const Pose& true_pose, std::uint64_t frame) const;

  const CameraRigOptions& options() const { return options_; }
  const PinholeCamera& depth_camera() const { return depth_camera_; }
  const std::shared_ptr<const SceneRenderer>& scene() const { return scene_; }

 private:
  Image image(const Eigen::Isometry3d& T_WC, const Twist& twist, std::uint64_t frame,
              std::uint64_t camera) const;

  std::shared_ptr<const SceneRenderer> scene_;
  CameraRigOptions options_;
  PinholeCamera depth_camera_;
};

}  // namespace prospect
