#include "adapters/robots/user/make_robot.h"

#include <exception>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>

#include "adapters/robots/faults/faulty_base.h"
#include "adapters/robots/faults/faulty_frames.h"
#include "runtime/clock.h"

namespace prospect {
namespace {

RobotDrivers made(const UserRobot& user) {
  RobotDrivers drivers = user.make ? user.make() : RobotDrivers();
  if (!drivers.base || !drivers.sensors) {
    throw std::invalid_argument(user.name + ": no " + (drivers.base ? "sensors" : "base") +
                                "; expected UserRobot::make to give both");
  }
  return drivers;
}

/// All that the robot's pointers share.
struct UserParts {
  explicit UserParts(const UserRobotConfiguration& o)
      : drivers(made(o.user)),
        start(clock.now()),
        base(*drivers.base, clock, o.faults, start),
        inbox(clock, FaultyFrames::inbox_options(o.inbox, o.faults)),
        frames(clock, inbox, o.faults, start, {o.robot.depth.min_range, o.robot.depth.max_range}),
        thread([this](const std::stop_token& stop) { deliver(stop); }) {}

  void deliver(const std::stop_token& stop) {
    std::string why = "the sensors have ended";
    try {
      drivers.sensors->deliver(frames, stop);
    } catch (const std::exception& e) {
      why = std::string("the sensors have failed: ") + e.what();
    }
    const std::lock_guard lock(mutex);
    if (!stop.stop_requested()) fault = why;
  }
  std::vector<std::string> faults() {
    const std::lock_guard lock(mutex);
    return fault.empty() ? std::vector<std::string>() : std::vector<std::string>{fault};
  }

  const SteadyClock clock;
  const RobotDrivers drivers;
  const double start;
  FaultyBase base;
  SensorInbox inbox;
  FaultyFrames frames;
  std::mutex mutex;
  std::string fault;
  const std::jthread thread;  // ends first
};

}  // namespace

Robot make_robot(const UserRobotConfiguration& options) {
  const auto parts = std::make_shared<UserParts>(options);
  Robot robot;
  robot.name = options.user.name;
  robot.clock = {parts, &parts->clock};
  robot.base = {parts, &parts->base};
  robot.frames = {parts, &parts->inbox};
  robot.streams = options.user.streams;
  robot.start = options.user.start;
  robot.start.position.z() = options.robot.base_height();
  robot.made = parts->start;
  robot.depth = options.user.depth;
  robot.emergency_stop = parts->drivers.emergency_stop.get();
  robot.link_faults = [parts] { return parts->faults(); };
  return robot;
}

}  // namespace prospect
