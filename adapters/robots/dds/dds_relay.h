// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "adapters/robots/dds/dds_options.h"

namespace prospect {

/// The dead-man of a base whose driver has none: a process of its own on the motors' side of the
/// link (runtime/base.h), started by what starts the motors. It passes commands on from
/// options.command.relay to the topics of the driver, at once, as far as its gate lets them
/// (command_gate.h): within options.command.limits, while they are younger than
/// options.command.dead_man, and of one publisher, there and on the topics of the driver, which is
/// named. Else it sends zero velocity, again and again.
/// Before the first command it sends nothing.
///
/// What it cannot do: stop the robot after it was killed itself.
///
/// Thread-safety: one thread; run() starts one more, of the node. Errors: the constructor throws
/// InputError, also if the options name no relay or lack a limit, and NotBuiltIn.
class DdsRelay {
 public:
  explicit DdsRelay(const DdsOptions& options);
  ~DdsRelay();

  /// Until `ended`, which is asked every period; then zero velocity for 0.2 s, if a command has
  /// ever come. `tell` gets a line when what is wrong with topics or
  /// commands changes.
  void run(const std::function<bool()>& ended, const std::function<void(const std::string&)>& tell);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace prospect
