// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/user/make_robot.h"

#include <algorithm>
#include <exception>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>
#include <vector>

#include "adapters/robots/faults/faulty_base.h"
#include "adapters/robots/faults/faulty_frames.h"
#include "adapters/robots/user/foreign_thread.h"
#include "adapters/robots/user/joined_robots.h"
#include "adapters/robots/user/return_deadline.h"
#include "adapters/robots/user/threaded_base.h"
#include "runtime/clock.h"

namespace prospect {
namespace {

RobotDrivers made(const UserRobotConfiguration& o) {
  check(o.user);
  const RobotDrivers drivers = [&] {
    const ReturnDeadline deadline(o.user.name + ": make()", ReturnDeadline::kMakePatience);
    return o.user.make(o.options);
  }();
  const bool sensors = !drivers.sensors.empty() &&
                       std::ranges::all_of(drivers.sensors, [](auto& s) { return s != nullptr; });
  if (!drivers.base || !sensors) {
    throw std::invalid_argument(
        o.user.name + ": no " + (drivers.base ? "sensors" : "base") +
        "; expected both of UserRobot::make, or the other of a second --base plugin:FILE");
  }
  return drivers;
}

/// All that the robot's pointers and threads share.
struct UserParts {
  explicit UserParts(const UserRobotConfiguration& o)
      : drivers(made(o)),
        start(clock.now()),
        threaded(drivers.base, o.priority),
        base(threaded, clock, o.faults, start),
        inbox(clock, FaultyFrames::inbox_options(o.inbox, o.faults)),
        frames(clock, inbox, o.faults, start, {o.robot.depth.min_range, o.robot.depth.max_range}) {}

  void deliver(SensorSource& source, const std::stop_token& stop) {
    std::string why = "the sensors have ended";
    try {
      source.deliver(frames, stop);
    } catch (const std::exception& e) {
      why = std::string("the sensors have failed: ") + e.what();
    } catch (...) {
      why = "the sensors have failed: an exception that is not a std::exception";
    }
    const std::lock_guard lock(mutex);
    if (!stop.stop_requested()) faults.push_back(why);
  }
  std::vector<std::string> told() {
    const std::lock_guard lock(mutex);
    return faults;
  }

  const SteadyClock clock;
  const RobotDrivers drivers;
  const double start;
  ThreadedBase threaded;
  FaultyBase base;
  SensorInbox inbox;
  FaultyFrames frames;
  std::mutex mutex;
  std::vector<std::string> faults;
};

/// The parts with the threads of the sensors, one that does not come back keeps the parts.
struct RunningParts {
  explicit RunningParts(const UserRobotConfiguration& o) : parts(std::make_shared<UserParts>(o)) {
    for (const std::shared_ptr<SensorSource>& source : parts->drivers.sensors) {
      threads.push_back(std::make_unique<ForeignThread>(
          [parts = parts, source](const std::stop_token& stop) { parts->deliver(*source, stop); }));
    }
  }

  const std::shared_ptr<UserParts> parts;
  std::vector<std::unique_ptr<ForeignThread>> threads;  // end first
};

}  // namespace

Robot make_robot(const UserRobotConfiguration& options) {
  const auto running = std::make_shared<RunningParts>(options);
  UserParts& parts = *running->parts;
  Robot robot;
  robot.name = options.user.name;
  robot.clock = {running, &parts.clock};
  robot.base = {running, &parts.base};
  robot.frames = {running, &parts.inbox};
  robot.streams = options.user.streams;
  robot.start = options.user.start;
  robot.start.position.z() = options.robot.base_height();
  robot.made = parts.start;
  robot.depth = options.user.depth;
  robot.more_depth = options.user.more_depth;
  robot.emergency_stop = parts.drivers.emergency_stop.get();
  robot.link_faults = [running] { return running->parts->told(); };
  return robot;
}

}  // namespace prospect
