// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <random>
#include <stop_token>
#include <string>

#include "adapters/missions/config/configuration.h"
#include "adapters/robots/simulator/simulated_base.h"
#include "adapters/robots/simulator/simulator.h"
#include "perception/pipeline/perception_pipeline.h"
#include "runtime/base.h"
#include "runtime/belief_source.h"
#include "runtime/clock.h"
#include "runtime/frame_sink.h"
#include "runtime/pose_velocity.h"
#include "runtime/sensor_inbox.h"

namespace prospect {

/// By what a simulated robot knows where it is.
enum class LocalizedBy {
  kCameras,  ///< a stereo pair and wheels, which are a model
  kWheels,   ///< wheels alone; it sees by a depth camera
  kPose      ///< a pose that it is told, 20 times a second; it has no wheels, and sees by a lidar
};
/// "cameras", "wheels", "pose"; else throws InputError.
LocalizedBy localized_by(const std::string& name);

/// Motors as a robot without cameras has them: with the motion of the wheels, or with the velocity
/// that the poses tell, which is 0.15 s old. Thread-safety: as Base; told() from any thread.
class ToldBase final : public Base {
 public:
  /// base outlives it.
  ToldBase(SimulatedBase& base, LocalizedBy by, const PoseJumpOptions& jump)
      : base_(base), by_(by), told_(jump) {}
  std::string name() const override { return base_.name(); }
  std::optional<double> dead_man() const override { return base_.dead_man(); }
  BaseLimits limits() const override { return base_.limits(); }
  void send(const Twist& command, double expires) override { base_.send(command, expires); }
  void stop() override { base_.stop(); }
  BaseReport report() override;
  void told(const ExternalPose& pose);
  LocalizedBy by() const { return by_; }
  SimulatedBase& motors() { return base_; }

 private:
  SimulatedBase& base_;
  const LocalizedBy by_;
  std::mutex mutex_;
  PoseVelocity told_;
};

/// What a robot without cameras knows on a simulated clock: ranges of the simulator, and wheels or
/// poses, through an inbox and the perception pipeline. The poses are true but for noise of 2 mm
/// and 2 mrad. Thread-safety: update() from one thread, which brings the world up to date with it.
class ToldBeliefs final : public BeliefSource, private FrameSink {
 public:
  /// frames: the inbox, or what stands before it. period: [s] from one belief to the next. All
  /// outlive it.
  ToldBeliefs(ToldBase& base, Simulator& simulator, const Clock& clock, SensorInbox& inbox,
              FrameSink& frames, double period, const Configuration& configuration);
  ~ToldBeliefs() override;
  ToldBeliefs(const ToldBeliefs&) = delete;
  ToldBeliefs& operator=(const ToldBeliefs&) = delete;

  std::shared_ptr<const Belief> update(const std::stop_token& stop) override;
  std::shared_ptr<const Belief> known() override { return perception_.belief(); }

 private:
  void observe(const SensorFrame& measured) override;  // by the simulator, in its time
  void tell_pose();

  ToldBase& base_;
  Simulator& simulator_;
  const Clock& clock_;
  SensorInbox& inbox_;
  FrameSink& frames_;
  const double period_;
  PerceptionPipeline perception_;
  double updated_;  // [s]
  std::mt19937_64 random_;
};

}  // namespace prospect
