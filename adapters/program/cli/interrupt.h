// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "runtime/drive_requests.h"

namespace prospect {

/// What SIGINT, SIGTERM and SIGHUP do to the program while this object lives, which is all of a
/// command, whatever it does. A SIGHUP that was ignored before stays ignored.
///
/// At first they end the program at once: exit code kCancelled, one line on standard error. So the
/// loops of no loader, of no library need to ask. Temporary files are removed, children end with
/// their parent, and what was written is whole.
///
/// Before a command makes what is to be kept, or moves a robot, it calls note(). From then on they
/// are only noted: the command asks came() in its loops, and ends by itself, soon, with what is
/// whole.
///
/// One at a time in a process. Thread-safety: note() by one thread, came() by any.
class SignalGuard {
 public:
  SignalGuard();
  /// The signals do again what they did before.
  ~SignalGuard();
  SignalGuard(const SignalGuard&) = delete;
  SignalGuard& operator=(const SignalGuard&) = delete;

  void note();
  /// Tells whether one was noted.
  std::function<bool()> came() const;
};

/// While it lives, SIGUSR1 is a person who acknowledges a stop that latches; afterwards the signal
/// does nothing. One at a time; `requests` must outlive it.
class AcknowledgementBySignal {
 public:
  explicit AcknowledgementBySignal(DriveRequests& requests);
  ~AcknowledgementBySignal();
  AcknowledgementBySignal(const AcknowledgementBySignal&) = delete;
  AcknowledgementBySignal& operator=(const AcknowledgementBySignal&) = delete;
};

}  // namespace prospect
