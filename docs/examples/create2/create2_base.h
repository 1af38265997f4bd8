// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "create2_relay.h"
#include "runtime/base.h"
#include "runtime/clock.h"

namespace prospect {

/// An iRobot Create 2 on a serial line as a Base: an example of a driver of one's own
/// (docs/tutorials/your_base.md). Commands go through a Create2Relay, which is its dead-man, with
/// the limits that stand there. Velocity and wheel motion are those of the encoders, over at least
/// kWindow; they are stamped when a packet comes, as the base has no clock that it tells. Bumper,
/// cliffs, wheels that hang, currents and charge are faults.
///
/// It starts a process: make it before threads. Errors: the constructor throws as Create2Relay
/// does. Later a line that is gone, a relay that has ended and what the base says are faults in
/// report(); a base that is silent shows in the report's stamp.
class Create2Base final : public Base {
 public:
  explicit Create2Base(const Create2Options& options);

  std::string name() const override { return "create2:" + options_.device; }
  std::optional<double> dead_man() const override { return options_.dead_man; }
  BaseLimits limits() const override;
  /// expires: of SteadyClock. The base turns and drives ahead; linear.y is not executed.
  void send(const Twist& command, double expires) override;
  void stop() override;
  BaseReport report() override;

  const Create2Relay& relay() const { return relay_; }

 private:
  static constexpr double kWindow = 0.04;  // [s] of packets for a velocity: counts are 0.4 mm

  void add(const Create2Relay::Word& word, BaseReport& report);

  const Create2Options options_;
  Create2Relay relay_;
  std::optional<Create2Relay::Word> counted_;  // until which wheel motion was reported
  Twist velocity_;
  double stamp_ = 0.0;
  bool speaks_ = false, unplugged_ = false;
  std::vector<std::string> faults_;  // of the newest packet
};

}  // namespace prospect
