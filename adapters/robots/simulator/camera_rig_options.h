// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "adapters/robots/simulator/camera_effects.h"
#include "models/camera.h"

namespace prospect {

class Knobs;

/// Cameras as the robot believes in them.
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
  double exposure_time = 0.0;  ///< [s] motion blur: see ImageSensor
  double read_noise = 1.5;     ///< [grey levels] one standard deviation in the dark
  double shot_noise = 0.02;    ///< variance a grey level [grey levels]

  // Depth.
  double depth_noise_constant = 0.0015;  ///< sigma = constant + quadratic z^2 [m; 1/m]
  double depth_noise_quadratic = 0.0016;
  double depth_dropout = 0.02;  ///< probability that a pixel measures nothing
  double max_incidence = 1.4;   ///< [rad] between ray and surface normal; beyond: nothing

  CameraEffects effects = scaled({}, 0.0);

  int threads = 1;
  std::uint64_t seed = 1;
};

/// The knobs (models/knobs.h); cameras, depth noise, effects and seed are the simulator's.
void describe(Knobs& knobs, CameraRigOptions& options);

}  // namespace prospect
