#include "adapters/missions/run/live_mission.h"

#include <stdexcept>
#include <string>
#include <utility>
#include <variant>

#include "engine/planner/planner.h"
#include "models/formatted.h"
#include "runtime/preflight_run.h"
#include "runtime/real_time_driver.h"
#include "runtime/seen_floor.h"
#include "solvers/registry.h"

namespace prospect {

MissionResult live_mission(const LiveRobot& robot, const Configuration& c,
                           const MissionOptions& mission,
                           const std::function<void(const MissionStep&)>& observe,
                           const ExplorationRunOptions& options, ExplorationRunResult& result) {
  PreflightFacts known;
  known.body = c.robot.slice();
  known.resolution = c.perception.mapping.resolution;
  const PreflightParts checked{.clock = robot.clock,
                               .base = robot.base,
                               .beliefs = robot.beliefs,
                               .guard = robot.guard,
                               .model = c.robot.model,
                               .inbox = robot.inbox,
                               .ranges = robot.ranges,
                               .streams = robot.streams,
                               .known = known,
                               .floor = robot.floor,
                               .requests = options.requests,
                               .emergency_stop = robot.emergency_stop,
                               .following = c.drive.driver.following};
  const PreflightResult preflight =
      run_preflight(checked, c.drive.preflight, c.drive.driver.command, options.cancelled);
  result.preflight = preflight.checks;
  const std::string failed = first_failed(preflight.checks);
  TappedReplanner planner(robot.planner, options.taps.planner);
  RealTimeDriver driver({.clock = robot.clock,
                         .base = robot.base,
                         .beliefs = robot.beliefs,
                         .planner = planner,
                         .guard = robot.guard,
                         .model = c.robot.model,
                         .inbox = robot.inbox,
                         .ranges = robot.ranges,
                         .failed_preflight = failed,
                         .yaw_checked = preflight.yaw_checked,
                         .emergency_stop = robot.emergency_stop,
                         .streams = robot.streams,
                         .preflight = preflight.checks,
                         .on_belief =
                             [&](const Belief& belief) {
                               if (robot.on_perceived) robot.on_perceived();
                               if (options.taps.belief) options.taps.belief(belief);
                             },
                         .on_command = options.taps.command,
                         .requests = options.requests},
                        c.drive.driver);
  MissionResult end;
  if (failed.empty()) {
    end = driver.run(mission, observe, [&] {
      if (options.taps.driver) options.taps.driver(driver, robot.clock.now());
      return options.cancelled && options.cancelled();
    });
    if (options.taps.driver) options.taps.driver(driver, robot.clock.now());
  } else {
    end.end =
        options.cancelled && options.cancelled() ? MissionEnd::kCancelled : MissionEnd::kNotFit;
    for (const CheckResult& check : preflight.checks) {
      if (check.check == failed)
        end.detail = "before the first motion: " + failed + ": " + check.why;
    }
  }
  result.driver = driver.status();
  result.health = driver.health();
  result.events = driver.events().since(0).events;
  return end;
}

std::function<void(const SensorFrame&)> frames_to(SensorTap tap) {
  struct Hand {
    SensorTap tap;
    void operator()(const StereoFrame& frame) const {
      if (tap.pair && frame.left && frame.right) {
        tap.pair(frame.left_stamp, {*frame.left, *frame.right});
      }
    }
    void operator()(const WheelSample& sample) const {
      if (tap.wheels) tap.wheels(sample);
    }
    void operator()(const DepthFrame& frame) const {
      if (tap.depth && frame.image) tap.depth(frame.stamp, *frame.image);
    }
    void operator()(const ScanFrame& frame) const {
      if (tap.scan && frame.in_B) tap.scan(frame.stamp, *frame.in_B);
    }
    void operator()(const EstimateFrame&) const {}  // no measurement
  };
  return [hand = Hand{std::move(tap)}](const SensorFrame& frame) { std::visit(hand, frame); };
}

std::function<void(const SensorFrame&)> PictureTap::frames() {
  return [this, hand = frames_to(taps_.sensors)](const SensorFrame& frame) {
    hand(frame);
    if (const auto* pair = std::get_if<StereoFrame>(&frame); pair && pair->left) left_ = pair->left;
  };
}

std::function<void()> PictureTap::perceived() {
  return [this] {
    if (left_ && taps_.picture) taps_.picture(*left_, perception_.odometry().sightings());
    left_.reset();
  };
}

std::function<std::optional<PreflightFacts::Floor>()> newest_floor(const SensorInbox& inbox,
                                                                   const RangeCamera& depth,
                                                                   double base_height) {
  return [&inbox, depth, base_height]() -> std::optional<PreflightFacts::Floor> {
    const DepthFrame newest = inbox.ranges().depth;
    if (!newest.image) return std::nullopt;
    return seen_floor(*newest.image, depth.camera, depth.mount, base_height, depth.range);
  };
}

MissionOptions mission_options_for(const Configuration& c,
                                   const std::function<SimulatedTruth()>& truth) {
  MissionOptions options = c.mission;
  options.task = c.planner.task;
  const double coverage = c.until_coverage, area = c.until_area;
  if (coverage > 0.0 || area > 0.0) {
    options.missing = [truth, coverage, area](const MissionStep&) -> std::string {
      const SimulatedTruth now = truth();
      if ((coverage > 0.0 && now.coverage >= coverage) || (area > 0.0 && now.seen_area >= area)) {
        return "";
      }
      return coverage > 0.0 ? formatted("%.1f of %g %% of what can be reached",
                                        100.0 * now.coverage, 100.0 * coverage)
                            : formatted("%.1f of %g m2", now.seen_area, area);
    };
  }
  return options;
}

std::unique_ptr<Replanner> planner_for(const Configuration& configuration,
                                       const ExplorationRunOptions& options) {
  if (options.make_planner) return options.make_planner(configuration);
  const SolverRegistry builtin;
  const SolverRegistry& solvers = options.solvers ? *options.solvers : builtin;
  auto planner = std::make_unique<Planner>(configuration.robot, configuration.planner,
                                           solvers.make(configuration.solver));
  planner->set_cancelled(options.cancelled);
  return planner;
}

void check_drives(const Configuration& configuration) {
  if (configuration.robot.model && configuration.robot.model->pose_layout().pz >= 0) {
    throw std::invalid_argument("robot.model is '" +
                                std::string(configuration.robot.model->name()) +
                                "', which flies; expected a model that drives, as frontiers and "
                                "the simulator are planar");
  }
  if (const std::string misfit =
          simulator_misfit(configuration.simulator, configuration.perception.mapping);
      !misfit.empty()) {
    throw std::invalid_argument(misfit);
  }
}

}  // namespace prospect
