// SPDX-License-Identifier: Apache-2.0
#include "runtime/event_log.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "models/formatted.h"
#include "models/knobs.h"

namespace prospect {
namespace {

/// Whether two texts are the same but for their numbers.
bool same_words(std::string_view a, std::string_view b) {
  const auto is_number = [](char c) {
    return (c >= '0' && c <= '9') || c == '.' || c == '-' || c == '+';
  };
  std::size_t i = 0, j = 0;
  for (;; ++i, ++j) {
    while (i < a.size() && is_number(a[i])) ++i;
    while (j < b.size() && is_number(b[j])) ++j;
    if (i == a.size() || j == b.size()) return i == a.size() && j == b.size();
    if (a[i] != b[j]) return false;
  }
}

/// Takes a new text, and keeps what was said before in other words.
void say(Event& event, std::string text) {
  std::string old = std::exchange(event.text, std::move(text));
  if (old.empty() || same_words(old, event.text)) return;
  std::erase_if(event.before, [&](const std::string& b) { return same_words(b, event.text); });
  event.before.push_back(std::move(old));
  if (event.before.size() <= kMostTexts) return;
  event.before.erase(event.before.begin());
  ++event.left_out;
}

}  // namespace

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
  if (event.count == 1) return text;
  text += formatted(" (%d times until %.3f", event.count, event.last_stamp);
  for (std::size_t k = 0; k < event.before.size(); ++k) {
    text += (k == 0 ? "; before: " : "; ") + event.before[k];
  }
  if (event.left_out > 0) text += formatted("; %d more", event.left_out);
  return text + ')';
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
  say(event, std::move(kept));
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
