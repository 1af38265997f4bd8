#pragma once

#include <functional>

#include "runtime/drive_requests.h"

namespace prospect {

/// From now on SIGINT, SIGTERM and SIGHUP no longer end the program; the function returned tells
/// whether one of them came. A SIGHUP that was ignored when the program started stays ignored. Call
/// before what is to be interrupted, once in a program.
std::function<bool()> catch_interrupts();

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
