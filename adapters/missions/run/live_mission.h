#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "adapters/missions/config/configuration.h"
#include "adapters/missions/run/exploration_run.h"
#include "adapters/robots/simulator/sensor_tap.h"
#include "adapters/robots/simulator/simulated_base.h"
#include "engine/planner/replanner.h"
#include "engine/safety/guard.h"
#include "models/image.h"
#include "perception/mapping/depth_image.h"
#include "perception/pipeline/perception_pipeline.h"
#include "runtime/base.h"
#include "runtime/belief_source.h"
#include "runtime/clock.h"
#include "runtime/mission.h"
#include "runtime/preflight.h"
#include "runtime/range_check.h"
#include "runtime/sensor_inbox.h"
#include "runtime/watched_stream.h"

namespace prospect {

/// A robot that is driven in real time, whatever its base; all of it outlives the mission.
struct LiveRobot {
  const Clock& clock;
  Base& base;
  BeliefSource& beliefs;
  Replanner& planner;
  const Guard& guard;
  SensorInbox* inbox = nullptr;        ///< gets the wheel motion that the base reports
  std::vector<WatchedStream> streams;  ///< without which it does not drive
  std::function<RangeCheck(const Twist&, double)> ranges{};
  std::function<std::optional<PreflightFacts::Floor>()> floor{};  ///< as seen at the start
  /// Who must be able to stop it; null: nobody but who asks by requests.
  const EmergencyStopInput* emergency_stop = nullptr;
  std::function<void()> on_perceived{};  ///< on the perception thread, before each new belief
};

/// Pre-flight (run_preflight()), then a mission by a RealTimeDriver, with the options of
/// configuration.drive. Fills in what `result` holds of a run in real time. A robot that fails a
/// check does not move: the mission ends as MissionEnd::kNotFit, and says which check.
/// observe and options.cancelled: as RealTimeDriver::run().
/// Throws what that and the constructors throw.
MissionResult live_mission(const LiveRobot& robot, const Configuration& configuration,
                           const MissionOptions& mission,
                           const std::function<void(const MissionStep&)>& observe,
                           const ExplorationRunOptions& options, ExplorationRunResult& result);

/// What hands a frame of an inbox to a tap, which is copied.
std::function<void(const SensorFrame&)> frames_to(SensorTap tap);

/// What the left camera showed, and what perception saw in it.
class PictureTap {
 public:
  /// tap: as of ExplorationRunOptions; all of it outlives this.
  PictureTap(const ExplorationRunOptions::Taps& taps, const PerceptionPipeline& perception)
      : taps_(taps), perception_(perception) {}
  /// Each frame, before perception takes it; handed on to Taps::sensors.
  std::function<void(const SensorFrame&)> frames();
  /// LiveRobot::on_perceived.
  std::function<void()> perceived();

 private:
  const ExplorationRunOptions::Taps& taps_;
  const PerceptionPipeline& perception_;
  std::shared_ptr<const Image> left_;  // newest that perception has not told of
};

/// LiveRobot::floor: that in the newest depth image of the inbox, which outlives it; none before
/// one has come. base_height [m]: of B above the floor.
std::function<std::optional<PreflightFacts::Floor>()> newest_floor(const SensorInbox& inbox,
                                                                   const RangeCamera& depth,
                                                                   double base_height);

/// Those of the configuration, with what is enough by what is true.
MissionOptions mission_options_for(const Configuration& configuration,
                                   const std::function<SimulatedTruth()>& truth);

/// The planner that the options make, or ours with the configured solver, whose steps
/// options.cancelled cuts short: asked on its thread, too. Throws std::invalid_argument for an
/// unknown solver.
std::unique_ptr<Replanner> planner_for(const Configuration& configuration,
                                       const ExplorationRunOptions& options);

/// Throws std::invalid_argument unless the model drives on the ground, and what its sensor measures
/// fits the map (simulator_misfit()).
void check_drives(const Configuration& configuration);

}  // namespace prospect
