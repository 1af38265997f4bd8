#pragma once

#include <cstdint>
#include <deque>
#include <limits>
#include <optional>
#include <vector>

#include "adapters/simulator/injected_fault.h"
#include "engine/maps/belief.h"
#include "runtime/clock.h"
#include "runtime/sensor_inbox.h"

namespace prospect {

/// The sensors of a simulated robot as streams of stamped frames, with faults: a left and a right
/// image and a depth scan for each belief that the simulator makes. They go through an inbox, which
/// pairs, shifts and refuses them as it does those of a real robot. A frame holds no picture, but
/// the number of the belief that belongs to it; what comes through decides which parts of which
/// belief are known: pose, twist, covariance, localization and landmarks are the cameras', maps and
/// ranges the depth sensor's. Nothing carries the pose on while no pair comes.
///
/// With a fault of the clock among the faults, the sensors have a clock of their own from the
/// start.
///
/// Thread-safety: through() from one thread; the inbox is for any.
class SimulatedStreams {
 public:
  /// The clock outlives it; the time of the faults begins at `start` [s] of it.
  SimulatedStreams(const Clock& clock, std::vector<InjectedFault> faults, double start);

  /// What is known of `belief`, just made, stamps in the runtime's clock. It is as old as its pose.
  /// None before the first pair: nothing is known of where the robot is.
  std::optional<Belief> through(Belief belief);

  const SensorInbox& inbox() const { return inbox_; }
  SensorInbox& inbox() { return inbox_; }

 private:
  struct Made {
    std::uint32_t number;
    Belief belief;
  };
  struct Stream {
    std::optional<std::uint32_t> newest{};  // number of the belief that was sent last
    double stamp = 0.0;                     // [s] that it had, in the sensors' clock
    double time = -std::numeric_limits<double>::infinity();  // [s] when it was sent
  };

  bool holds(FaultSource source, FaultVerb verb, double time) const {
    return fault_at(faults_, source, verb, time) != nullptr;
  }
  /// What is to be sent of a stream now; none: nothing. With the number of a belief and its stamp.
  struct Frame {
    std::uint32_t number;
    double stamp;
  };
  std::optional<Frame> next(Stream& stream, FaultSource source, double now, double time,
                            double SourceStamps::*capture) const;
  void send_image(FaultSource source, Stream& stream, double now, double time);
  void send_depth(double now, double time);
  const Belief* made(std::uint32_t number) const;

  const Clock& clock_;
  const std::vector<InjectedFault> faults_;
  const double start_;
  SensorInbox inbox_;
  std::deque<Made> made_;  // the newest ones, for what is delayed
  std::uint32_t number_ = 0;
  Stream left_, right_, depth_;
  std::optional<Belief> of_cameras_, of_depth_;  // the newest that came through
};

}  // namespace prospect
