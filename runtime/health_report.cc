// SPDX-License-Identifier: Apache-2.0
#include "runtime/health_report.h"

#include <algorithm>
#include <cmath>

#include "models/formatted.h"

namespace prospect {
namespace {

bool beyond(const SourceHealth& source) { return !(source.age <= source.limit); }
bool answers(const ThreadReport& thread) {
  return thread.state == ThreadState::kOnTime || thread.state == ThreadState::kStarting;
}

Severity level_of(const DriveState& state) {
  switch (state.mode) {
    case DriveMode::kStopped:
      return Severity::kFatal;
    case DriveMode::kStopping:
      if (latches(state.cause)) return Severity::kFatal;
      return state.cause == DriveCause::kToldToStand || state.cause == DriveCause::kTaskOver
                 ? Severity::kInfo
                 : Severity::kError;
    case DriveMode::kDegraded:
      return Severity::kWarning;
    default:
      return Severity::kInfo;
  }
}

std::string age_text(double seconds) {
  return std::isfinite(seconds) ? duration_text(seconds) : "none yet";
}

}  // namespace

Severity level(const HealthReport& report) {
  Severity worst = level_of(report.drive);
  const auto at_least = [&](Severity severity) { worst = std::max(worst, severity); };
  for (const SourceHealth& source : report.sources) {
    if (beyond(source)) at_least(Severity::kError);
  }
  for (const ThreadReport& thread : report.threads) {
    if (!answers(thread)) at_least(Severity::kError);
  }
  for (const CheckResult& check : report.preflight) {
    if (check.verdict == CheckVerdict::kFailed) at_least(Severity::kError);
    if (check.verdict == CheckVerdict::kWarned) at_least(Severity::kWarning);
  }
  for (const Event& event : report.newest) at_least(event.severity);
  return worst;
}

std::string to_text(const HealthReport& report) {
  std::string text = formatted("%.3f s, %s: %s since %.3f s, %s, %.0f %% of the speed\n",
                               report.stamp, to_string(level(report)).data(),
                               to_string(report.drive.mode).data(), report.drive.since,
                               to_string(report.speed.response).data(), 100.0 * report.speed.share);
  if (!report.why.empty()) text += "  " + report.why + '\n';
  const auto mark = [](bool bad) { return bad ? "! " : "  "; };
  for (const SourceHealth& s : report.sources) {
    text += mark(beyond(s)) + ("source " + s.name) + ": age " + age_text(s.age) + ", limit " +
            duration_text(s.limit) + ", " + std::to_string(s.received) + " received, " +
            std::to_string(s.dropped) + " dropped\n";
  }
  for (const ThreadReport& t : report.threads) {
    text += mark(!answers(t)) + ("thread " + t.name) + ": " + std::string(to_string(t.state)) +
            ", age " + age_text(t.age) + ", limit " + duration_text(t.limit) + '\n';
  }
  for (const NamedLatency& l : report.latencies) {
    text += "  latency " + l.name + ": " + l.histogram.to_text() + '\n';
  }
  if (report.preflight.empty()) text += "  pre-flight: not made\n";
  for (const CheckResult& c : report.preflight) {
    if (c.verdict == CheckVerdict::kPassed) continue;
    text += mark(c.verdict == CheckVerdict::kFailed) + ("check " + c.check) + ": " +
            std::string(to_string(c.verdict)) + ": " + c.why + '\n';
  }
  text += "  events:";
  for (const Severity severity : kSeverities) {
    text += ' ' + std::to_string(report.events.of(severity)) + ' ' +
            std::string(to_string(severity)) + ',';
  }
  text += ' ' + std::to_string(report.events.dropped) + " dropped\n";
  for (const Event& event : report.newest) {
    text += mark(event.severity >= Severity::kError) + to_text(event) + '\n';
  }
  return text;
}

}  // namespace prospect
