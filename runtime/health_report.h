// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "runtime/drive_mode.h"
#include "runtime/event_log.h"
#include "runtime/latency_histogram.h"
#include "runtime/preflight.h"
#include "runtime/supervisor.h"

namespace prospect {

struct SourceHealth {
  std::string name;
  double age = 0.0, limit = 0.0;  ///< [s] since the newest capture; infinite age: none yet
  std::uint64_t received = 0;
  std::uint64_t dropped = 0;  ///< received and not used: no pair, no time, too late
};

struct NamedLatency {
  std::string name;  ///< "capture to wheel"
  LatencyHistogram histogram;
};

/// How a robot is at one instant: what a status page shows and a log holds. A value.
struct HealthReport {
  double stamp = 0.0;  ///< [s] in the runtime's clock
  DriveState drive;
  DriveSpeed speed;
  std::string why;  ///< describe() of the drive state
  std::vector<SourceHealth> sources;
  std::vector<ThreadReport> threads;
  std::vector<NamedLatency> latencies;
  EventLog::Totals events;
  std::vector<Event> newest;           ///< events to be shown
  std::vector<CheckResult> preflight;  ///< empty: not made
};

/// The worst of what the report holds; of events only those to be shown.
///   fatal    stopped, or stopping for a cause that latches;
///   error    stopping for another cause but the end of a task or of being told to drive; a source
///            beyond its limit; a thread that is late, ended or never started; a failed check;
///   warning  degraded; a warning of a check;
///   info     else.
/// An event counts with its severity.
Severity level(const HealthReport& report);

/// Some lines of text: mode and why, then a line each for sources, threads, latencies, checks that
/// did not pass, and events. What is beyond its limit stands behind "!".
std::string to_text(const HealthReport& report);

}  // namespace prospect
