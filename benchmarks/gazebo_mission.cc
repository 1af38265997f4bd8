// A mission in Gazebo, in real time, with this project's own perception: nothing but the pose at
// the start is taken from what Gazebo knows to be true, which only measures.
//   prospect export office --sdf office.sdf && scripts/gazebo start office.sdf
//   gazebo_mission office [--time-limit S] [--solver NAME] [--port N] [--set KEY=VALUE]...
// WORLD is the world that was exported: it says what can be reached and what is a contact. Prints
// the pre-flight checks, a line every 10 s, and what came of the mission: the share of the
// reachable area that the robot's map holds, the error of the pose against the truth, losses,
// contacts, latencies, and seconds of simulation a second.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "adapters/config/configuration.h"
#include "adapters/config/registries.h"
#include "adapters/gazebo/gazebo_base.h"
#include "adapters/gazebo/gazebo_sensors.h"
#include "adapters/gazebo/gazebo_truth.h"
#include "adapters/gazebo/gazebo_world_file.h"
#include "adapters/run/exploration_run.h"
#include "adapters/simulator/camera_rig.h"
#include "adapters/simulator/kinematic_robot.h"
#include "adapters/simulator/known_free.h"
#include "adapters/worlds/load_world.h"
#include "benchmarks/guarded_main.h"
#include "benchmarks/program_options.h"
#include "engine/planner/planner.h"
#include "engine/planner/planner_guard.h"
#include "perception/pipeline/perception_pipeline.h"
#include "runtime/preflight.h"
#include "runtime/real_time_driver.h"

namespace prospect {
namespace {

constexpr double kWheelScale = 0.1;  // of Gazebo's wheels, which slip: one standard deviation

PerceptionOptions perception_of(const Configuration& c, const PinholeCamera& depth_camera,
                                const Pose& start) {
  PerceptionOptions perception;
  perception.stereo_mount = c.robot.stereo_mount;
  perception.depth_camera = {depth_camera, c.robot.depth_mount};
  perception.mapping.map = c.simulator.mapping;
  const VerticalExtent slice = c.robot.slice();
  perception.mapping.map.slice.z_min = slice.z_min;
  perception.mapping.map.slice.z_max = slice.z_max;
  perception.mapping.map.slice.sight =
      c.robot.base_height() + c.robot.depth_mount.T_BC.translation().z();
  perception.mapping.map.max_range = c.robot.depth.max_range;
  perception.mapping.range = {c.robot.depth.min_range, c.robot.depth.max_range};
  perception.wheel_fusion.sigma_scale = kWheelScale;
  perception.max_age = std::min(perception.max_age, perception.wheel_fusion.max_wait);
  perception.start = start;
  return perception;
}

/// Drives at a velocity for so long, or until it is enough; a thread feeds perception meanwhile.
/// The turn by the wheels [rad].
double drive_by_hand(GazeboBase& base, SensorInbox& inbox, BeliefSource& beliefs,
                     const Clock& clock, const Twist& command, double seconds,
                     const std::function<bool()>& enough = {}) {
  const std::jthread perceives([&](const std::stop_token& stop) {
    while (!stop.stop_requested()) beliefs.update(stop);
  });
  double turned = 0.0, before = 0.0;
  const double end = clock.now() + seconds;
  while (clock.now() < end && !(enough && enough())) {
    base.send(command, clock.now() + 0.2);
    for (const WheelSample& sample : base.report().wheels) {
      inbox.wheels(sample);
      if (before > 0.0) turned += sample.yaw_rate * (sample.stamp - before);
      before = sample.stamp;
    }
    clock.wait_until(clock.now() + 0.02, {});
  }
  base.stop();
  return turned;
}

/// The streams of a robot that stands, once each has been live for as long as it must be, or after
/// 20 s.
std::vector<PreflightFacts::Stream> watched_streams(GazeboBase& base, SensorInbox& inbox,
                                                    BeliefSource& beliefs, const Clock& clock,
                                                    const Guard::Options& limits) {
  std::vector<PreflightFacts::Stream> streams = {{"cameras", 0.0, limits.max_pose_age},
                                                 {"depth", 0.0, limits.max_ranges_age},
                                                 {"wheels", 0.0, limits.max_pose_age}};
  constexpr std::array kStreams = {SensorStream::kPair, SensorStream::kDepth,
                                   SensorStream::kWheels};
  std::array<double, 3> live_since{};
  live_since.fill(clock.now());
  drive_by_hand(base, inbox, beliefs, clock, {}, 20.0, [&] {
    const double now = clock.now();
    bool live = true;
    for (std::size_t n = 0; n < streams.size(); ++n) {
      PreflightFacts::Stream& stream = streams[n];
      stream.age = now - inbox.count(kStreams[n]).newest.value_or(-1e9);
      if (!(stream.age <= stream.limit)) live_since[n] = now;
      stream.live_for = now - live_since[n];
      live = live && stream.live_for > PreflightOptions().live_time;
    }
    return live;
  });
  return streams;
}

/// The pose at a time, between two of the truth; none: outside.
std::optional<Pose> truth_at(const std::vector<GazeboTruth::Stamped>& truth, double time,
                             double offset) {
  const auto after =
      std::lower_bound(truth.begin(), truth.end(), time - offset,
                       [](const GazeboTruth::Stamped& t, double stamp) { return t.stamp < stamp; });
  if (after == truth.begin() || after == truth.end()) return std::nullopt;
  const GazeboTruth::Stamped &a = *(after - 1), &b = *after;
  const double share = (time - offset - a.stamp) / (b.stamp - a.stamp);
  Pose pose;
  pose.position = a.pose.position + share * (b.pose.position - a.pose.position);
  pose.yaw = a.pose.yaw + share * std::remainder(b.pose.yaw - a.pose.yaw, 2.0 * M_PI);
  return pose;
}

struct Estimate {
  double stamp = 0.0;
  Pose pose;
};

int run(int argc, char** argv) {
  std::string world_name = "office", solver = "nlopt";
  std::vector<std::string> settings;
  double time_limit = 180.0;
  int port = GazeboAddress().port;
  ProgramOptions program("A mission in Gazebo with this project's own perception");
  program.add("world", world_name, "That was exported");
  program.add("--time-limit", time_limit, "Of the mission [s]", {.least = 1.0, .most = 1e6});
  program.add("--solver", solver, "Back end");
  program.add("--port", port, "Of Gazebo's master", {.least = 1, .most = 65535});
  program.add("--set", settings, "A value of the configuration, KEY=VALUE");
  if (const std::optional<int> code = program.parse(argc, argv)) return *code;

  const Registries registries;
  Configuration c = read_configuration("", registries, settings);
  c.robot.stereo = gazebo_stereo(c.robot.stereo);
  c.mission.time_limit = time_limit;
  const World world = load_world(world_name, world_options_for(c));
  const ReachableArea reachable = reachable_area(world, c);
  const ContactTest contact(world, c.robot.shape, c.robot.base_height());

  GazeboOptions options;
  options.address.port = port;
  const SteadyClock clock;
  GazeboBase base(options, clock);  // before all threads, as it forks
  // The simulation's time does not keep up with the wall clock while the machine is busy.
  SensorInbox inbox(clock, {.clock_drift = 0.1});
  const GazeboSensors sensors(options, inbox);
  GazeboTruth truth(options);

  const int width = GazeboWorldOptions().depth_width;
  const int height =
      static_cast<int>(std::lround(width * std::tan(0.5 * c.robot.depth.vertical_fov) /
                                   std::tan(0.5 * c.robot.depth.horizontal_fov)));
  Pose start = world.start;
  start.position.z() = c.robot.base_height();
  const PerceptionOptions perceiving =
      perception_of(c, depth_camera(c.robot.depth, width, height), start);
  PerceptionPipeline perception(c.robot.stereo, perceiving);
  for (const Disc& d : known_free(world, start, contact.radius(), c.robot.slice(),
                                  c.simulator.mapping.resolution)) {
    perception.map().clear_cylinder({d.center.x(), d.center.y(), start.position.z()}, d.radius,
                                    perceiving.mapping.map.slice.z_max - start.position.z());
  }
  PipelineBeliefs beliefs(inbox, perception);
  Guard::Options limits = c.guard;
  limits.max_map_age = std::max(limits.max_map_age, 0.5);
  limits.max_ranges_age = std::max(limits.max_ranges_age, 0.5);
  const Guard guard = guard_for(c.robot, c.planner, limits);
  const RealTimeOptions driving;

  // Before the first motion, and a turn by 0.2 rad.
  PreflightFacts facts;
  facts.body = c.robot.slice();
  facts.resolution = c.simulator.mapping.resolution;
  facts.stereo_offset = 0.0;  // a pair is one message of one instant
  facts.streams = watched_streams(base, inbox, beliefs, clock, limits);
  facts.dead_man = base.dead_man();
  facts.longest_thread_limit =
      std::max({driving.perception_limit, driving.planner_limit, driving.command_limit});
  facts.speed.model = c.robot.model->max_speed();
  facts.yaw_rate.model = c.robot.model->max_yaw_rate();
  facts.deceleration.model = c.robot.model->max_deceleration();
  std::vector<CheckResult> checks = checks_before_motion(facts);
  if (first_failed(checks).empty()) {
    const double yaw = perception.pose(clock.now()).yaw;
    YawTurn turn{.commanded = 0.2};
    turn.wheels = drive_by_hand(base, inbox, beliefs, clock, {{}, 0.4}, 0.5);
    *turn.wheels += drive_by_hand(base, inbox, beliefs, clock, {}, 0.5);
    turn.cameras = std::remainder(perception.pose(clock.now()).yaw - yaw, 2.0 * M_PI);
    for (const CheckResult& r : checks_of_turn(turn)) checks.push_back(r);
  }
  std::printf("%s", to_text(checks).c_str());
  for (const std::string& fault : sensors.faults()) std::printf("fault: %s\n", fault.c_str());
  if (!first_failed(checks).empty()) return 1;

  Planner planner(c.robot, c.planner, registries.solvers.make(solver));
  RealTimeDriver driver({.clock = clock,
                         .base = base,
                         .beliefs = beliefs,
                         .planner = planner,
                         .guard = guard,
                         .model = c.robot.model,
                         .inbox = &inbox,
                         .failed_preflight = first_failed(checks),
                         .yaw_checked = true},
                        driving);
  std::vector<Estimate> estimates;
  std::shared_ptr<const GroundMap> ground;
  int losses = 0;
  bool lost = false;
  const double begin = clock.now();
  double next = 0.0;
  const auto known_share = [&] {
    const GridFrame& frame = reachable.cells.frame;
    int known = 0, all = 0;
    for (int n = 0; n < frame.size(); ++n) {
      if (reachable.cells.data[static_cast<std::size_t>(n)] == 0) continue;
      ++all;
      const Eigen::Vector2d p = frame.center(frame.at(n));
      known += ground && ground->state(ground->frame().cell(p.x(), p.y())) == CellState::kFree;
    }
    return all > 0 ? static_cast<double>(known) / all : 0.0;
  };
  const MissionResult result = driver.run(c.mission, [&](const MissionStep& step) {
    estimates.push_back({step.belief->stamp, step.belief->pose});
    ground = step.belief->ground;
    const bool lost_now = step.belief->localization == Localization::kLost;
    losses += lost_now && !lost;
    lost = lost_now;
    if (step.time < next) return;
    next += 10.0;
    std::printf("%6.1f s  at (%.2f, %.2f)  explored %4.1f %%  %s  %s\n", step.time,
                step.belief->pose.position.x(), step.belief->pose.position.y(),
                100.0 * known_share(), driver.status().why.c_str(), step.plan->why.c_str());
    std::fflush(stdout);
  });
  const double wall = clock.now() - begin;

  const std::vector<GazeboTruth::Stamped> poses = truth.take();
  if (poses.empty())
    throw InputError("no true pose came; expected a model '" + options.model + "'");
  double offset = poses.front().arrival - poses.front().stamp;
  for (const auto& p : poses) offset = std::min(offset, p.arrival - p.stamp);
  std::vector<double> errors;
  for (const Estimate& e : estimates) {
    const std::optional<Pose> at = truth_at(poses, e.stamp, offset);
    if (at) errors.push_back((e.pose.position - at->position).head<2>().norm());
  }
  double path = 0.0;
  int contacts = 0;
  bool touches = false;
  for (std::size_t n = 1; n < poses.size(); ++n) {
    path += (poses[n].pose.position - poses[n - 1].pose.position).head<2>().norm();
    Pose upright = poses[n].pose;
    upright.position.z() = c.robot.base_height();
    const bool now_touches = contact.in_contact(upright);
    contacts += now_touches && !touches;
    touches = now_touches;
  }
  const auto first =
      std::find_if(poses.begin(), poses.end(), [&](const auto& p) { return p.arrival >= begin; });
  const double simulated = first == poses.end() ? 0.0 : poses.back().stamp - first->stamp;
  const double wall_of_it = first == poses.end() ? 1.0 : poses.back().arrival - first->arrival;
  const DriverStatus status = driver.status();
  std::printf("%s: %s%s%s\n", world_name.c_str(), std::string(to_string(result.end)).c_str(),
              result.detail.empty() ? "" : ", ", result.detail.c_str());
  std::printf("  explored      %6.1f %% of %.1f m2 that can be reached\n", 100.0 * known_share(),
              reachable.area);
  std::printf("  time          %6.1f s, %.2f s simulated a second\n", wall, simulated / wall_of_it);
  std::printf("  path          %6.1f m\n", path);
  std::printf("  contacts      %6d    losses of localization %d\n", contacts, losses);
  if (!errors.empty()) {
    double square = 0.0;
    for (const double e : errors) square += e * e;
    std::printf("  localization  %6.3f m final, %.3f m RMS, %.3f m largest\n", errors.back(),
                std::sqrt(square / static_cast<double>(errors.size())),
                *std::max_element(errors.begin(), errors.end()));
  }
  std::printf("  planning      %d steps, %d fallbacks, %d late, %d guard stops; %s\n", result.steps,
              result.fallbacks, status.late_plans, status.guard_stops,
              status.planning.to_text().c_str());
  std::printf("  capture to command  %s\n", status.capture_to_command.to_text().c_str());
  std::printf("  command period      %s\n", status.command_period.to_text().c_str());
  for (const SensorStream s : {SensorStream::kPair, SensorStream::kDepth, SensorStream::kWheels}) {
    const StreamCount n = inbox.count(s);
    std::printf("  %-13s %llu came, %llu taken, %llu too many, %llu too old, %llu refused %s\n",
                std::string(to_string(s)).c_str(), static_cast<unsigned long long>(n.received),
                static_cast<unsigned long long>(n.taken),
                static_cast<unsigned long long>(n.overflown),
                static_cast<unsigned long long>(n.too_old),
                static_cast<unsigned long long>(n.refused), n.reason.c_str());
  }
  for (const Event& event : driver.events().since(0).events) {
    std::printf("  event %s\n", to_text(event).c_str());
  }
  return result.done() || result.end == MissionEnd::kTimeLimit ? 0 : 1;
}

}  // namespace
}  // namespace prospect

int main(int argc, char** argv) {
  return prospect::guarded_main("gazebo_mission", prospect::run, argc, argv);
}
