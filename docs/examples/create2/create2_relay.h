// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "create2_protocol.h"
#include "models/types.h"
#include "runtime/relay_process.h"

namespace prospect {

struct Create2Options {
  std::string device = "/dev/ttyUSB0";
  int rate = 115200;      ///< [baud]
  double dead_man = 0.3;  ///< [s] 0.05 to 2
  double period = 0.05;   ///< [s] 0.01 to 1, in which a stop is said again
  double patience = 2.0;  ///< [s] > 0 in which the base must begin to speak
};

/// The dead-man that a Create 2 lacks, which holds its last velocity for ever: a process of its own
/// that alone talks to it. It passes on each command that has not expired. When the newest one is
/// expired, or older than its dead-man's time, it sends zero velocity, and again with every period.
/// When who started it ends, in whatever way, it sends zero velocity, leaves the base's interface,
/// which switches the motors off, and ends. A base that has left its safe mode is put back into it,
/// once nothing keeps it from it.
///
/// It stands on the computer's side of the cable. So it holds against threads and programs that
/// hang or die. A cable that is pulled, or a computer that stops, it cannot help: the base then
/// drives on until its own bumper, cliff or wheel sensors stop it.
///
/// As any RelayProcess it is started before threads are. Thread-safety: one thread at a time;
/// send() and newest() return at once.
class Create2Relay {
 public:
  /// One packet of the base.
  struct Word {
    double stamp = 0.0;  ///< [s] of SteadyClock when it came
    Create2Sensors sensors;
    bool unplugged = false;  ///< instead of a packet: the line is gone
  };

  /// Waits until the base speaks. Throws std::invalid_argument if the line cannot be opened, or
  /// nothing that can be understood comes within the patience.
  explicit Create2Relay(const Create2Options& options);

  /// `expires` [s] of SteadyClock. False: it was not taken.
  bool send(const Twist& velocity, double expires) noexcept;
  /// All packets since it was asked last, oldest first.
  std::vector<Word> newest() noexcept;
  bool ended() const { return ended_; }  ///< the process: nothing stops the base any more

  int process() const { return process_->process(); }

 private:
  std::optional<RelayProcess> process_;  // from the constructor on
  bool ended_ = false;
  std::vector<Word> first_;  // what came while it was waited for
};

}  // namespace prospect
