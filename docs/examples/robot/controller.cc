// A robot with Prospect inside, in real time: motors that take commands with an expiry, a lidar
// whose scans go through the inbox, a localization of its own, and the driver's threads between.
#include <cstdio>
#include <string>
#include <thread>

#include "engine/planner/planner.h"
#include "models/unicycle.h"
#include "pretended_lidar.h"
#include "runtime/driver.h"
#include "runtime/preflight_run.h"
#include "runtime/range_stop.h"
#include "solvers/registry.h"

using namespace prospect;

class MyRobot final : public Base, public BeliefSource {
 public:
  MyRobot(const Clock& clock, SensorInbox& inbox, const PerceptionOptions& options)
      : clock_(clock), inbox_(inbox), perception_(options), moved_(clock.now()) {
    perception_.map().clear_cylinder({0, 0, 0}, 0.4, 0.6);  // where it stands is free
  }

  // Called by the command thread. A real driver talks to its motors; these do as they are told
  // until a command expires or their dead-man's time is over.
  std::string name() const noexcept override { return "pretended robot"; }
  std::optional<double> dead_man() const noexcept override { return 0.4; }  // [s]
  void send(const Twist& command, double expires) noexcept override {
    pose();
    const std::lock_guard lock(mutex_);
    command_ = command;
    expires_ = std::min(expires, moved_ + *dead_man());
  }
  void stop() noexcept override { send({}, clock_.now()); }
  BaseReport report() noexcept override {
    pose();
    const std::lock_guard lock(mutex_);
    return {true, moved_, command_, {}, {}};  // connected; no wheel motion, no faults
  }

  // Called by the perception thread: the robot's own pose, and what waits in the inbox.
  std::shared_ptr<const Belief> update(const std::stop_token& stop) override {
    if (!inbox_.wait(0.1, stop)) return nullptr;
    const Pose at = pose();
    const double now = clock_.now();
    perception_.external_pose({now, in_space(at)});
    while (const auto frame = inbox_.take()) feed(perception_, *frame);
    return perception_.belief(now);
  }

  // Called by the lidar's thread.
  void look_around() { inbox_.scan(clock_.now(), turn_of_lidar(pose())); }

 private:
  // Where the motors have brought it by now.
  Pose pose() {
    const std::lock_guard lock(mutex_);
    const double now = clock_.now();
    Eigen::VectorXd next(model_.nx());
    model_.step(model_.state(pose_, command_), model_.input(command_),
                std::max(0.0, std::min(now, expires_) - moved_), next);
    if (now >= expires_) command_ = {};
    moved_ = now;
    return pose_ = model_.pose(next);
  }

  const Clock& clock_;
  SensorInbox& inbox_;
  PerceptionPipeline perception_;
  const Unicycle model_;
  std::mutex mutex_;  // of what follows
  Pose pose_;
  Twist command_;
  double moved_, expires_ = 0.0;
};

// Whoever watches the mission: on the planner's thread, after each step.
class Printed final : public MissionObserver {
  void on_step(const MissionStep& step) override {
    const Twist v = step.plan->command_at(step.plan->stamp);
    std::printf("%5.2f s: knows %.1f m2; %.3f m/s, %+.3f rad/s; guard %s; %s\n", step.time,
                step.global_plan->explored_area, v.linear.x(), v.yaw_rate,
                to_string(step.guard_reason).data(), step.plan->why.c_str());
  }
};

int main() {
  RobotDescription description;
  description.model = std::make_shared<Unicycle>();
  description.shape = CylinderShape{.center = {0, 0, 0.3}, .radius = 0.18, .height = 0.4};
  description.depth.horizontal_fov = 2.0 * M_PI, description.depth.vertical_fov = 0.0;
  description.depth.max_range = kLidarRange;
  PlannerParameters parameters;
  parameters.weights.visible_features = 0.0;  // no camera, so no features to keep in view
  Planner planner(description, parameters, make_solver("nlopt"));
  Guard::Options limits;
  limits.max_landmarks_age = std::numeric_limits<double>::infinity();
  const Guard guard = planner.make_guard(limits);

  const SteadyClock clock;
  SensorInbox inbox(clock, {.scan_in_runtime_clock = true});
  PerceptionOptions perceives;
  perceives.wheels = false, perceives.mapping.max_range = kLidarRange;
  perceives.mapping.slice = height_slice(description);
  MyRobot robot(clock, inbox, perceives);
  std::jthread lidar([&](const std::stop_token& stop) {
    do robot.look_around();
    while (clock.wait_until(clock.now() + 0.1, stop));
  });

  const RangeStop by_ranges;  // stops before what the map does not know
  const DriverParts parts{.clock = clock,
                          .guard = guard,
                          .model = description.model,
                          .dead_man = robot.dead_man(),
                          .inbox = &inbox,
                          .ranges = range_check(inbox, by_ranges, {}),
                          .streams = {watched(inbox, SensorStream::kScan, "lidar", 1.0)}};
  const DriverOptions options;
  const PreflightResult checked =  // and a small turn
      run_preflight(parts, robot, robot, {}, options, {.known = {.body = description.slice()}});
  Printed printed;
  MissionOptions mission{.time_limit = 20.0};
  mission.missing = [](const MissionStep& step) -> std::string {
    return step.global_plan->explored_area > 33.0 ? "" : "33 m2 were not seen";
  };
  mission.observers = {&printed};
  Driver driver(parts, planner, checked, options, mission);
  const MissionResult result = driver.run(robot, robot);
  std::printf("%s%s\ncapture to command: %s\n", to_text(checked.checks).c_str(),
              result.detail.c_str(), driver.status().capture_to_command.to_text().c_str());
}
