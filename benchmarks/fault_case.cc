// SPDX-License-Identifier: Apache-2.0
#include "benchmarks/fault_case.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>
#include <utility>

#include "adapters/missions/run/exploration_run.h"
#include "adapters/missions/run/live_mission.h"
#include "adapters/robots/faults/faulty_base.h"
#include "adapters/robots/faults/faulty_disk.h"
#include "adapters/robots/faults/faulty_frames.h"
#include "adapters/robots/faults/faulty_replanner.h"
#include "adapters/robots/simulator/simulated_base.h"
#include "adapters/robots/simulator/simulated_clock.h"
#include "adapters/robots/simulator/simulated_streams.h"
#include "adapters/robots/simulator/simulator.h"
#include "engine/planner/planner.h"
#include "engine/planner/planner_guard.h"
#include "runtime/driver.h"
#include "runtime/watched_stream.h"
#include "solvers/registry.h"

namespace prospect {
namespace {

constexpr double kStart = 100.0;    // [s] of the clock
constexpr int kThreads = 4;         // of a driver, with the caller of run()
constexpr double kImuRate = 100.0;  // [Hz]

struct Sample {
  double time = 0.0;  // [s] since the start
  double path = 0.0, speed = 0.0;
  bool stands = true;
  bool commanded = false;  // the base holds a command
  bool named = false;      // it is to stop: the drive mode says why
  std::string cause;       // of the drive mode or the command; empty: the plan's command
};

/// What a person sees who looks at the robot whenever it makes a belief, and acknowledges.
class Watched final : public BeliefSource {
 public:
  Watched(const SimulatedBase& base, BeliefSource& beliefs, const SimulatedClock& clock,
          const FaultCase& one)
      : base_(base), beliefs_(beliefs), clock_(clock), one_(one) {}

  std::shared_ptr<const Belief> update(const std::stop_token& stop) override {
    // Beliefs and commands are due at the same instants: commands first, in each drive.
    if (!begun_) clock_.until_waited_for(kThreads - 1);
    begun_ = true;
    std::shared_ptr<const Belief> belief = beliefs_.update(stop);
    const double time = clock_.now() - kStart;
    Driver* driver = driver_;
    if (!driver || (!samples_.empty() && time <= samples_.back().time)) return belief;
    const DriverStatus status = driver->status();
    Sample sample;
    sample.time = time;
    sample.path = base_.newest().path_length;
    if (!samples_.empty()) {
      const Sample& before = samples_.back();
      sample.speed = (sample.path - before.path) / (time - before.time);
    }
    sample.stands = !(sample.speed > 0.01) && !turns();
    const bool drives =
        status.mode.mode == DriveMode::kActive || status.mode.mode == DriveMode::kDegraded;
    sample.commanded = base_.holds_command();
    sample.named =
        status.mode.mode == DriveMode::kStopping || status.mode.mode == DriveMode::kStopped;
    if (!drives) {
      sample.cause = to_string(status.mode.cause);
    } else if (status.reason != CommandReason::kPlan) {
      sample.cause = to_string(status.reason);
    }
    samples_.push_back(sample);
    const double end = one_.faults.front().from + one_.faults.front().duration;
    if (status.mode.mode == DriveMode::kStopped && time > end + one_.patience) {
      driver->requests().acknowledge();
      acknowledged_ = true;
    }
    return belief;
  }

  void look_at(Driver& driver) { driver_ = &driver; }
  const std::vector<Sample>& samples() const { return samples_; }
  bool acknowledged() const { return acknowledged_; }

 private:
  /// Whether it has turned since the last time.
  bool turns() {
    const double yaw = base_.newest().pose.yaw;
    return std::abs(std::exchange(yaw_, yaw) - yaw) > 0.001;
  }

  const SimulatedBase& base_;
  BeliefSource& beliefs_;
  const SimulatedClock& clock_;
  const FaultCase one_;
  std::atomic<Driver*> driver_{nullptr};
  std::vector<Sample> samples_;
  double yaw_ = 0.0;
  bool begun_ = false, acknowledged_ = false;
};

void judge(const std::vector<Sample>& samples, const FaultCase& one, FaultOutcome& outcome) {
  constexpr double kAfter = 2.0, kAtEnd = 3.0;  // [s]
  const double from = one.faults.front().from, end = from + one.faults.front().duration;
  double path = 0.0, stood_since = -1.0;
  bool stood_at_end = false;
  for (const Sample& sample : samples) {
    if (sample.time <= from) {
      path = sample.path;
      outcome.speed = sample.speed;
      continue;
    }
    if (sample.named && !outcome.named_time && sample.time <= end) {
      outcome.named_time = sample.time - from;
      outcome.named_distance = sample.path - path;
    }
    // What comes first is why it stands.
    if (!outcome.stop_time && outcome.cause.empty()) outcome.cause = sample.cause;
    if (sample.stands && !outcome.stop_time && sample.time <= end + kAfter) {
      outcome.stop_time = sample.time - from;
      outcome.stop_distance = sample.path - path;
      if (outcome.cause.empty()) outcome.cause = sample.commanded ? "plan" : "expiry";
    }
    if (sample.time <= end) stood_at_end = sample.stands;
    if (sample.time > end && stood_at_end && !sample.stands && !outcome.recovery) {
      outcome.recovery = sample.time - end;
    }
    if (!sample.stands) {
      stood_since = -1.0;
      outcome.drives_at_end = outcome.drives_at_end || sample.time > one.length - kAtEnd;
    } else {
      if (stood_since < 0.0) stood_since = sample.time;
      outcome.longest_stand = std::max(outcome.longest_stand, sample.time - stood_since);
    }
  }
}

}  // namespace

Configuration fault_drive_configuration(const std::string& world, LocalizedBy by) {
  std::vector<YamlSetting> settings = {"planner.polished=1", "planner.polish_evaluations=20"};
  if (world == "corridor") {
    settings.insert(settings.end(), {"task.kind=go", "task.goal=[12, 0]",
                                     "simulator.odometry.perfect=true", "planner.weights.w_l=0"});
  }
  if (by == LocalizedBy::kPose) {
    settings.insert(
        settings.end(),
        {"robot.shape={type: cylinder, radius: 0.18, height: 0.4, center: [0, 0, 0.3]}",
         "robot.depth={horizontal_fov: 360, vertical_fov: 0, mount: {position: [0.05, 0, 0.3]}}"});
  }
  return read_configuration("", {}, settings);
}

FaultOutcome drive_with_fault(const std::shared_ptr<const World>& world,
                              const Configuration& configuration, const FaultCase& one) {
  const SimulatedClock clock(kThreads, kStart);
  const std::vector<InjectedFault>& faults = one.faults;
  SimulatorOptions simulator_options = configuration.simulator;
  simulator_options.seed = one.seed;
  const bool has_imu = has_source(faults, FaultSource::kImu);
  if (has_imu) simulator_options.imu.rate = kImuRate;
  Simulator simulator(world, simulator_options, configuration.perception);
  const SimulatedBaseOptions base_options;
  SimulatedBase base(simulator, clock, *configuration.robot.model, base_options);
  const SensorInboxOptions inbox_options = in_runtime_clock(inbox_of(configuration));
  ToldBase told_base(base, one.by, inbox_options.pose_jump);
  FaultyBase faulty_base(told_base, clock, faults, kStart);
  SensorInbox inbox(clock, FaultyFrames::inbox_options(inbox_options, faults));
  const RgbdFootprint& seen = configuration.robot.depth;
  FaultyFrames frames(clock, inbox, faults, kStart, {seen.min_range, seen.max_range});
  std::unique_ptr<BeliefSource> beliefs;
  if (one.by == LocalizedBy::kCameras) {
    beliefs = std::make_unique<SimulatedStreams>(base, simulator, clock, inbox, frames,
                                                 base_options.belief_period);
  } else {
    beliefs = std::make_unique<ToldBeliefs>(told_base, simulator, clock, inbox, frames,
                                            base_options.belief_period, configuration);
  }
  Watched watched(base, *beliefs, clock, one);
  Planner planner(configuration.robot, configuration.planner,
                  SolverRegistry().make(configuration.solver));
  FaultyReplanner faulty(planner, *configuration.robot.model, clock, faults, kStart);
  FaultyDisk disk(clock, faults, kStart);
  Guard::Options ages = configuration.guard;
  if (one.by != LocalizedBy::kCameras)
    ages.max_landmarks_age = std::numeric_limits<double>::infinity();
  const Guard guard = guard_for(configuration.robot, configuration.planner, ages);
  MissionOptions mission = configuration.mission;
  mission.time_limit = one.length;
  mission.observers = {&disk};
  std::vector<WatchedStream> streams;
  if (has_imu) {
    streams = {prospect::watched(inbox, SensorStream::kImu, "imu", inbox_options.max_wheel_age)};
  }
  Driver driver({.clock = clock,
                 .guard = guard,
                 .model = configuration.robot.model,
                 .dead_man = faulty_base.dead_man(),
                 .inbox = &inbox,
                 .pose_of_wheels = one.by == LocalizedBy::kWheels,
                 .streams = streams},
                faulty, PreflightResult{.checks = {}, .yaw_checked = true}, {}, mission);
  watched.look_at(driver);
  driver.run(faulty_base, watched);

  FaultOutcome outcome;
  judge(watched.samples(), one, outcome);
  outcome.acknowledged = watched.acknowledged();
  outcome.contacts = simulator.collisions();
  for (const Event& event : driver.events().since(0).events) {
    if (event.severity != Severity::kInfo) outcome.events.push_back(to_text(event));
  }
  return outcome;
}

std::string to_text(const FaultOutcome& o) {
  char text[200];
  std::string line;
  if (o.stop_time) {
    std::snprintf(text, sizeof text, "stopped by %s after %.2f s and %.2f m", o.cause.c_str(),
                  *o.stop_time, *o.stop_distance);
  } else {
    std::snprintf(text, sizeof text, "drove on, from %.2f m/s", o.speed);
  }
  line = text;
  if (o.recovery) {
    std::snprintf(text, sizeof text, "; drove again %.2f s after the fault", *o.recovery);
    line += text;
  }
  if (o.acknowledged) line += ", once acknowledged";
  if (!o.drives_at_end) line += "; stood at the end";
  if (o.contacts > 0) line += "; " + std::to_string(o.contacts) + " contacts";
  return line;
}

}  // namespace prospect
