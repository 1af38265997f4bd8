// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "adapters/robots/simulator/seen_area.h"
#include "adapters/robots/simulator/walkers.h"
#include "engine/maps/belief.h"
#include "engine/maps/correction.h"
#include "engine/maps/planar_move.h"
#include "models/imu_sample.h"
#include "models/robot_shape.h"
#include "models/types.h"
#include "runtime/camera_picture.h"
#include "runtime/frame_sink.h"

namespace prospect {

/// How a simulated robot perceives: images and depth scans, taken at true poses, become an estimate
/// and maps. FeatureSensors models that, CameraSensors does it.
///
/// The simulator calls image() and scan() in order of time, image() first where both are due, but
/// for the very first ones, at time 0: scan(), then image(). Thread-safety: one thread; beliefs may
/// be read anywhere. Nothing here throws. Deterministic in what it was made of and the sequence of
/// calls.
class SimulatedSensors {
 public:
  virtual ~SimulatedSensors() = default;

  /// A stereo image at `stamp` [s], taken at a true pose while the robot moves with `twist`.
  virtual void image(double stamp, const Pose& true_pose, const Twist& twist) = 0;
  /// A depth image; what its rays have passed and met is entered in `seen`.
  virtual void scan(double stamp, const Pose& true_pose, SeenArea& seen) = 0;
  /// From now on enter() alone takes in what the depth sensor and an IMU measure: where their
  /// frames take their time, or other ways.
  void leave_ranges() { enters_ranges_ = false; }
  /// What an IMU measured, of its time. Nothing after leave_ranges().
  virtual void imu(const ImuSample&) {}
  /// A frame of the depth sensor or the IMU, as if taken at `stamp` [s]. Any other does nothing.
  virtual void enter(double stamp, const SensorFrame& ranges) = 0;

  /// What the robot knows now, at a true pose reached since the newest image. `commanded` is the
  /// twist that it executes.
  virtual std::shared_ptr<const Belief> belief(double stamp, const Pose& true_pose,
                                               const Twist& commanded) = 0;
  /// The pose of that belief.
  virtual Pose estimate(double stamp, const Pose& true_pose) const = 0;
  virtual Localization localization() const = 0;
  virtual int losses() const = 0;  ///< how often localization was lost
  /// The robot was carried from one true pose to another, and knows that, but not where it is.
  /// known_free: as at the start, about where it is [m, in the true frame].
  virtual void carry(const Pose& from, const Pose& true_pose,
                     const std::vector<Disc>& known_free) = 0;
  /// Somebody corrects (correction.h). Whether it is taken, beliefs say from then on.
  virtual void correct(const Correction& correction, const Pose& true_pose) = 0;
  /// Where W lies in the frame of the start by these.
  virtual PlanarMove origin() const { return {}; }
  /// Why the sensors cannot be trusted, e.g. a calibration that is wrong; empty: nothing is known
  /// against them.
  virtual std::string complaint() const { return {}; }
  /// Who gets what is measured from now on, with the simulator's time [s], on the thread that the
  /// sensors are used on: stereo pairs, wheel motion, depth images, scans. Null: nobody.
  void deliver_to(FrameSink* sink) { sink_ = sink; }

  /// Who is there, as they are when an image or a scan is taken; outlives this. Null: nobody.
  void among(const Walkers* walkers) { walkers_ = walkers; }

  /// The newest left image; without an image where there is none.
  virtual CameraPicture picture() const { return {}; }

 protected:
  void deliver(const SensorFrame& frame) {
    if (sink_ != nullptr) sink_->observe(frame);
  }
  std::span<const Walker> walkers() const {
    return walkers_ != nullptr ? walkers_->walkers() : std::span<const Walker>();
  }
  bool enters_ranges_ = true;  // at once

 private:
  FrameSink* sink_ = nullptr;
  const Walkers* walkers_ = nullptr;
};

}  // namespace prospect
