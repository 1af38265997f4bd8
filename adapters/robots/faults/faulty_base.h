// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "adapters/robots/faults/faulty_motion.h"
#include "adapters/robots/faults/injected_fault.h"
#include "runtime/base.h"
#include "runtime/clock.h"

namespace prospect {

/// Any base with injected faults (injected_fault.h) of its link, of its wheels' encoders, of what
/// its motors make of a command, and of the command thread, which report() makes wait. Its dead-man
/// stays: it stops the base when commands do not come.
///
/// Thread-safety: as Base.
class FaultyBase final : public Base {
 public:
  /// base and clock outlive it; the time of the faults begins at `start` [s].
  FaultyBase(Base& base, const Clock& clock, std::vector<InjectedFault> faults, double start);

  std::string name() const noexcept override { return base_.name(); }
  std::optional<double> dead_man() const noexcept override { return base_.dead_man(); }
  BaseLimits limits() const noexcept override { return base_.limits(); }
  void send(const Twist& command, double expires) noexcept override;
  void stop() noexcept override;
  BaseReport report() noexcept override;

 private:
  struct Command {
    double comes = 0.0, expires = 0.0;  // [s]
    Twist twist;
  };
  bool holds(FaultSource source, FaultVerb verb, double now) const {
    return fault_at(faults_, source, verb, now - start_) != nullptr;
  }
  /// What the encoders measured until a report.
  struct Measured {
    double time = 0.0;  // [s]
    Twist velocity;
    std::vector<WheelSample> wheels;
  };
  bool link_passes(double now) const;
  void pass_late(double now) noexcept;
  Twist measured(Twist velocity, double now);
  void measure(BaseReport& fresh, double now);

  Base& base_;
  const Clock& clock_;
  const std::vector<InjectedFault> faults_;
  const double start_;
  FaultyMotion motion_;
  std::deque<Command> late_;
  double last_sent_ = -1e9, last_told_ = -1e9;
  BaseReport told_;               // the newest that passed, without its wheel samples
  std::deque<Measured> waiting_;  // not told yet
  std::optional<Twist> stuck_;
};

}  // namespace prospect
