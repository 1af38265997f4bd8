// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <vector>

#include "adapters/robots/simulator/camera_effects.h"
#include "adapters/robots/simulator/camera_rig_options.h"
#include "adapters/robots/simulator/exposure_control.h"
#include "adapters/robots/simulator/image_sensor.h"
#include "benchmarks/rendered_sequence.h"
#include "models/camera.h"
#include "models/image.h"

namespace prospect {

/// A rendered sequence as the simulator's cameras would take it: calibration, light, exposure, blur
/// and dirt are drawn for its number. The room has no people, and its floor does not shine.
class RealCameras {
 public:
  /// believed: what the odometry is told.
  RealCameras(const RenderedSequence& sequence, const StereoCamera& believed, double realism)
      : sequence_(sequence),
        options_(options(sequence, believed, realism)),
        stereo_(true_stereo(believed, options_.effects, options_.seed)),
        left_(options_, stereo_.camera, 0),
        right_(options_, stereo_.camera, 1),
        control_(options_.effects.exposure_lag) {}

  /// In order.
  ImagePair render(int frame) {
    const Eigen::Isometry3d& T_WC = sequence_.path()[static_cast<std::size_t>(frame)];
    const Eigen::Isometry3d& before =
        sequence_.path()[static_cast<std::size_t>(frame > 0 ? frame - 1 : 0)];
    const Eigen::AngleAxisd turn(before.linear().transpose() * T_WC.linear());
    const double stamp = RenderedSequence::kPeriod * frame;
    const ImageMoment moment{static_cast<std::uint64_t>(frame), stamp, control_.exposure(),
                             turn.angle() / RenderedSequence::kPeriod};
    const auto image = [&](const ImageSensor& sensor, const Eigen::Isometry3d& at) {
      const Image sharp = sequence_.image(stereo_.camera, at);
      return sensor.image({sharp.pixels.begin(), sharp.pixels.end()}, at, moment);
    };
    ImagePair pair{image(left_, T_WC), image(right_, T_WC * stereo_.T_LR)};
    control_.measured(stamp, pair.left);
    return pair;
  }

 private:
  static CameraRigOptions options(const RenderedSequence& sequence, const StereoCamera& believed,
                                  double realism) {
    CameraRigOptions rig;
    rig.stereo = believed;
    rig.effects = scaled({}, realism);
    rig.seed = static_cast<std::uint64_t>(sequence.number());
    return rig;
  }

  const RenderedSequence& sequence_;
  CameraRigOptions options_;
  TrueStereo stereo_;
  ImageSensor left_, right_;
  ExposureControl control_;
};

}  // namespace prospect
