// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "adapters/robots/user/foreign_thread.h"
#include "runtime/base.h"

namespace prospect {

/// A base whose driver somebody else wrote. Its send(), stop() and report() run on a thread of
/// their own, in the order in which they were asked for, the newest command in the place of one
/// that waits. So the command thread goes on whatever the driver does, and what goes wrong is a
/// fault, which stops the robot:
///   * an exception: "its driver failed in send(): ...", told until a call of that kind goes well;
///   * a call that does not return: "its driver has not returned from report() for 0.6 s: ...";
///     nothing reaches the motors then, and the base's own dead-man stops them;
///   * a fault without words has some, and none has more than a line.
/// report() waits for the driver for kPatience; later the answer before counts, with its stamp, so
/// that a driver that lags shows as a base that is silent. Without any it is not connected.
///
/// Thread-safety: as Base. At its end the driver has ForeignThread::kPatience to come back; one
/// that does not is left, with all that it holds.
class ThreadedBase final : public Base {
 public:
  static constexpr double kPatience = 0.01;  ///< [s] for an answer
  static constexpr double kLongest = 0.5;    ///< [s] that a call may take before it is a fault

  /// priority: of the thread (realtime_priority.h). Throws std::invalid_argument, "its base failed
  /// in limits(): ...", for what the driver throws when it is asked who it is.
  ThreadedBase(std::shared_ptr<Base> base, int priority);

  std::string name() const noexcept override { return name_; }
  std::optional<double> dead_man() const noexcept override { return dead_man_; }
  BaseLimits limits() const noexcept override { return limits_; }
  void send(const Twist& command, double expires) noexcept override;
  void stop() noexcept override;
  BaseReport report() noexcept override;

 private:
  struct Calls;

  std::string name_;
  std::optional<double> dead_man_;
  BaseLimits limits_;
  std::shared_ptr<Calls> calls_;  // shared with the thread
  ForeignThread thread_;
};

}  // namespace prospect
