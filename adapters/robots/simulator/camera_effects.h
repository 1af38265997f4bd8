// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>

#include "models/camera.h"

namespace prospect {

class Knobs;

/// What real cameras do that ideal ones do not, at its full size; scaled() makes it smaller or
/// nothing. Where each number comes from stands beside it.
struct CameraEffects {
  // Calibration: what is drawn once for a mission, one standard deviation. The robot believes the
  // camera that it is told; the images are those of the true one. Stereo calibrations by a board
  // come back with such spreads, and so the odometry is told (perception.odometry.calibration).
  double focal_length = 0.003;   ///< of itself, of both cameras alike
  double principal_point = 0.8;  ///< [px], each coordinate, of both cameras alike
  double baseline = 0.005;       ///< of itself: a millimetre in 20 cm of board and rig
  /// [rad] of the right camera against the left one, each axis: 0.4 px of disparity and of rows at
  /// a focal length of 450 px. The KITTI clip's own: 0.3 mrad (docs/decisions/disparity_zero.md).
  double rotation = 0.05 * M_PI / 180.0;
  double mount = 0.2 * M_PI / 180.0;  ///< [rad] of a camera against the body, each axis

  // Light.
  double light = 0.3;         ///< log brightness of places and directions, one standard deviation
  double exposure_lag = 0.3;  ///< [s] in which the exposure follows to 1 - 1/e; 0: it does not
  /// [s] of exposure in light of brightness 1: usual indoors.
  double shutter = 0.008;
  /// Share of their mean by which lamps flicker, at twice the mains' frequency: 0.1 for good LEDs
  /// to 0.4 for fluorescent lamps with magnetic ballast (IEEE 1789-2015).
  double flicker = 0.25;
  double readout = 0.015;  ///< [s] between the first and the last row's exposure
  double glare = 40.0;     ///< [grey levels] of stray light towards a window, at its brightest

  // Things.
  double people = 1.0;  ///< that walk on 100 m^2 of floor
  double dirt = 0.2;    ///< share of the light that a spot on the lens takes
  /// Share of light that the floor reflects as a mirror, straight down: that of any smooth surface
  /// of index 1.5. Towards grazing it grows 25-fold.
  double floor_shine = 0.04;
};

/// The knobs (models/knobs.h).
void describe(Knobs& knobs, CameraEffects& effects);

/// `effects` times `share`, times in which things happen left alone; 0: none of them, and an image
/// is what it is without, bit for bit.
inline CameraEffects scaled(CameraEffects effects, double share) {
  CameraEffects& e = effects;
  for (double* amount :
       {&e.focal_length, &e.principal_point, &e.baseline, &e.rotation, &e.mount, &e.light,
        &e.shutter, &e.flicker, &e.glare, &e.people, &e.dirt, &e.floor_shine}) {
    *amount *= share;
  }
  if (share == 0.0) e.exposure_lag = 0.0;
  return effects;
}

/// The stereo pair that takes the images, where the robot believes in another.
struct TrueStereo {
  PinholeCamera camera;    ///< of both
  Eigen::Isometry3d T_LR;  ///< the right camera's pose in the left one's frame [m]
};

/// Draws: sums of four uniform numbers, variance 1, at most 3.5, functions of the seed.
TrueStereo true_stereo(const StereoCamera& believed, const CameraEffects& effects,
                       std::uint64_t seed);
PinholeCamera true_camera(PinholeCamera believed, const CameraEffects& effects, std::uint64_t seed);
CameraMount true_mount(CameraMount believed, const CameraEffects& effects, std::uint64_t seed);

}  // namespace prospect
