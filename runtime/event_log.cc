// SPDX-License-Identifier: Apache-2.0
#include "runtime/event_log.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "models/formatted.h"
#include "models/knobs.h"

namespace prospect {

std::string_view to_string(Severity severity) {
  switch (severity) {
    case Severity::kInfo:
      return "info";
    case Severity::kWarning:
      return "warning";
    case Severity::kError:
      return "error";
    case Severity::kFatal:
      return "fatal";
  }
  return "?";
}

std::string to_text(const Event& event) {
  std::string text = formatted("%.3f ", event.stamp) + std::string(to_string(event.severity)) +
                     ' ' + event.source + ": " + event.cause;
  if (!event.text.empty()) text += ": " + event.text;
  if (event.count > 1) text += formatted(" (%d times until %.3f)", event.count, event.last_stamp);
  return text;
}

EventLog::EventLog(const EventLogOptions& options) : options_(options) {
  check_knobs("event log", options_);
}

void EventLog::add(double stamp, Severity severity, std::string_view source, std::string_view cause,
                   std::string_view text) {
  const auto longest = static_cast<std::size_t>(options_.longest_text);
  std::string kept(text.substr(0, longest));
  if (text.size() > longest) kept.replace(longest - 3, 3, "...");

  const std::lock_guard lock(mutex_);
  ++totals_.by_severity[static_cast<std::size_t>(severity)];
  const auto same = std::find_if(events_.rbegin(), events_.rend(), [&](const Event& e) {
    return e.severity == severity && e.source == source && e.cause == cause &&
           std::abs(stamp - e.last_stamp) <= options_.repeat_gap;
  });
  Event event;
  if (same == events_.rend()) {
    event.stamp = stamp;
    event.severity = severity;
    event.source = source;
    event.cause = cause;
  } else {
    event = std::move(*same);
    events_.erase(std::next(same).base());
    ++event.count;
  }
  event.last_stamp = stamp;
  event.text = std::move(kept);
  event.number = next_++;
  events_.push_back(std::move(event));
  if (events_.size() > static_cast<std::size_t>(options_.capacity)) {
    first_complete_ = events_.front().number + 1;
    events_.pop_front();
    ++totals_.dropped;
  }
}

EventLog::Reading EventLog::since(std::uint64_t number) const {
  const std::lock_guard lock(mutex_);
  const auto first =
      std::lower_bound(events_.begin(), events_.end(), number,
                       [](const Event& e, std::uint64_t least) { return e.number < least; });
  return {{first, events_.end()}, next_, number >= first_complete_};
}

EventLog::Totals EventLog::totals() const {
  const std::lock_guard lock(mutex_);
  return totals_;
}

}  // namespace prospect
