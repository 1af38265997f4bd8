// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

namespace prospect {

class Knobs;

enum class Severity {
  kInfo,     ///< part of ordinary work
  kWarning,  ///< the robot goes on, with less
  kError,    ///< the robot stops, and may go on by itself
  kFatal     ///< the robot stops, and waits for a person
};
inline constexpr std::array kSeverities = {Severity::kInfo, Severity::kWarning, Severity::kError,
                                           Severity::kFatal};
/// "info", "warning", "error", "fatal".
std::string_view to_string(Severity severity);

/// Something that happened, and how often in a row. Stamps in the runtime's monotonic clock [s].
struct Event {
  double stamp = 0.0;  ///< when it happened first
  Severity severity = Severity::kInfo;
  std::string source;  ///< who says so: "left camera", "planner thread"
  std::string cause;   ///< a name that stays the same for the same fault: "stale"
  std::string text;    ///< a sentence with the numbers of the newest time
  /// What it said before in other words, each with its newest numbers, oldest first; of more than
  /// kMostTexts the oldest are left out, and counted.
  std::vector<std::string> before{};
  int left_out = 0;
  double last_stamp = 0.0;  ///< when it happened last
  int count = 1;
  /// Number of the newest time in the order of the log, from 0.
  std::uint64_t number = 0;
};

inline constexpr std::size_t kMostTexts = 20;

/// "12.345 error left camera: stale: 0.7 s old; expected at most 0.5 s (23 times until 14.200)",
/// and what it said before: "(2 times until 14.200; before: no image so far)".
std::string to_text(const Event& event);

struct EventLogOptions {
  int capacity = 1000;      ///< events that are kept
  double repeat_gap = 2.0;  ///< [s] an event that comes again within it is counted
  int longest_text = 500;   ///< characters; what is longer is cut and ends in "..."
};
/// The knobs (models/knobs.h).
void describe(Knobs& knobs, EventLogOptions& options);

/// The newest events, in the order of their numbers.
///
/// Repetitions. An event is the same as one that is kept if source, cause and severity are, and it
/// comes within repeat_gap of the last time. Then that one is counted up, takes the new text, stamp
/// and number, and moves to the end. So a fault that is there at each of 50 commands a second is
/// one event. A text that differs in more than its numbers is kept beside the newest.
///
/// Overflow. Beyond the capacity the event with the least number is dropped, and counted.
///
/// Thread-safety: all functions may be called concurrently. A call holds a mutex for a search
/// through, or a copy of, what is kept. Errors: the constructor throws std::invalid_argument for
/// options out of range.
class EventLog {
 public:
  explicit EventLog(const EventLogOptions& options = {});

  void add(double stamp, Severity severity, std::string_view source, std::string_view cause,
           std::string_view text);

  struct Reading {
    std::vector<Event> events;
    std::uint64_t next = 0;  ///< to be asked for the next time
    /// Nothing that had a number from the one asked for on was dropped.
    bool complete = true;
  };
  /// Events whose number is `number` or more. An event that has happened again since it was read is
  /// there again, with a larger count.
  Reading since(std::uint64_t number) const;

  struct Totals {
    std::array<std::uint64_t, kSeverities.size()> by_severity{};  ///< each time counts
    std::uint64_t dropped = 0;                                    ///< events
    std::uint64_t of(Severity severity) const {
      return by_severity[static_cast<std::size_t>(severity)];
    }
  };
  /// Since the log was made.
  Totals totals() const;

 private:
  EventLogOptions options_;
  mutable std::mutex mutex_;
  std::deque<Event> events_;  // by number
  std::uint64_t next_ = 0;
  std::uint64_t first_complete_ = 0;  // nothing from this number on was dropped
  Totals totals_;
};

}  // namespace prospect
