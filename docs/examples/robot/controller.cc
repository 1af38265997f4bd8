// SPDX-License-Identifier: Apache-2.0
// A robot of one's own as a whole program: motors that take commands with an expiry, a lidar and a
// localization. Prospect brings the rest: checks, threads, guard, log, live view, report, faults.
#include <algorithm>
#include <memory>
#include <mutex>
#include <thread>

#include "adapters/program/robot/run_robot.h"
#include "models/body_transform.h"
#include "models/unicycle.h"
#include "pretended_lidar.h"
#include "runtime/clock.h"

using namespace prospect;

class MyBase final : public Base {
 public:
  // Called by the command thread. A real driver talks to its motors; these do as they are told
  // until a command expires or their dead-man's time is over.
  std::string name() const override { return "pretended base"; }
  std::optional<double> dead_man() const override { return 0.4; }  // [s]
  void send(const Twist& command, double expires) override {
    pose();
    const std::lock_guard lock(mutex_);
    command_ = command;
    expires_ = std::min(expires, moved_ + *dead_man());
  }
  void stop() override { send({}, clock_.now()); }
  BaseReport report() override {
    pose();
    const std::lock_guard lock(mutex_);
    return {true, moved_, command_, {}, {}};  // connected; no wheel motion, no faults
  }

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

 private:
  const SteadyClock clock_;
  const Unicycle model_;
  std::mutex mutex_;  // of what follows
  Pose pose_;
  Twist command_;
  double moved_ = clock_.now(), expires_ = 0.0;
};

class MySensors final : public SensorSource {
 public:
  explicit MySensors(std::shared_ptr<MyBase> base) : base_(std::move(base)) {}

  // On a thread of its own: ten times a second the pose, and a turn of the lidar.
  void deliver(FrameSink& frames, const std::stop_token& stop) override {
    const SteadyClock clock;
    do {
      const double now = clock.now();
      const Pose at = base_->pose();
      frames.observe(ExternalPose{.stamp = now, .T_WB = body_transform(at)});
      frames.observe(ScanFrame{now, std::make_shared<const DepthScan>(turn_of_lidar(at))});
    } while (clock.wait_until(clock.now() + 0.1, stop));
  }

 private:
  const std::shared_ptr<MyBase> base_;
};

int main(int argc, char** argv) {
  UserRobot robot;
  robot.name = "my_robot";
  robot.streams = {SensorStream::kPose, SensorStream::kScan};
  robot.settings = {"robot.shape={type: cylinder, radius: 0.18, height: 0.4, center: [0, 0, 0.3]}",
                    "robot.depth={horizontal_fov: 360, vertical_fov: 0, max_range: 3}",
                    "drive.inbox.poses_in_runtime_clock=true",
                    "drive.inbox.scan_in_runtime_clock=true"};
  robot.make = [](const Options&) {
    const auto base = std::make_shared<MyBase>();
    return RobotDrivers{.base = base, .sensors = {std::make_shared<MySensors>(base)}};
  };
  return run_robot(argc, argv, robot);
}
