// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "adapters/robots/simulator/camera_rig_options.h"
#include "adapters/robots/simulator/world_light.h"
#include "models/camera.h"
#include "models/image.h"

namespace prospect {

/// When and how an image is taken.
struct ImageMoment {
  std::uint64_t frame = 0;
  double stamp = 0.0;     ///< [s]
  double exposure = 1.0;  ///< of the control (exposure_control.h)
  double yaw_rate = 0.0;  ///< of the body [rad/s]
};

/// One camera's lens and sensor: what becomes of the grey that its rays meet, in this order.
///
/// - Stray light towards the window (world_light.h): glare exp(-r^2 / 2 s^2) grey levels, r from
/// the
///   window's place in the image, s a third of its width; none with the window behind.
/// - Gain: exposure x the control's x brightness x lamps of the row's time, stamp + readout v /
///   height; x vignetting. The control lengthens the exposure, shutter x exposure, to 20 ms at
///   most; what lacks is amplified, a times.
/// - Dirt: five soft spots at their places, of radius 2 to 6 % of the width, each takes the share
///   `dirt` in its middle and gives as much of a plain grey, 100 x gain.
/// - The lens' blur; motion blur, a box along the rows of fx |yaw_rate| T pixels, T = exposure_time
///   plus the control's time: the flow of far points while the body turns (what its translation
///   adds is left out, as is what it moves between rows).
/// - Gaussian noise of variance (a read_noise)^2 + a shot_noise x grey; rounded.
///
/// Noise is a function of (seed, frame, camera, pixel) alone - a hash, four of its bytes summed for
/// a Gaussian of at most 3.5 sigma -, so images do not depend on which were taken before, and the
/// bits not on the number of threads. Immutable: concurrent calls are safe.
class ImageSensor {
 public:
  /// camera: the true one. number: of the camera in the rig, 0 left.
  ImageSensor(const CameraRigOptions& options, const PinholeCamera& camera, std::uint64_t number);

  /// grey: levels, rows without gaps, as SceneRenderer::intensity() gives them.
  Image image(std::vector<float> grey, const Eigen::Isometry3d& T_WC,
              const ImageMoment& moment) const;

  /// Length of the motion blur [px].
  double motion_blur(const ImageMoment& moment) const;

 private:
  double control_time(const ImageMoment& moment) const;  // [s]
  void expose(std::vector<float>& grey, const Eigen::Isometry3d& T_WC,
              const ImageMoment& moment) const;

  CameraRigOptions options_;
  PinholeCamera camera_;
  std::uint64_t number_;
  WorldLight light_;
  std::vector<float> clean_;  // share of the light that dirt leaves, of each pixel; empty: all
};

}  // namespace prospect
