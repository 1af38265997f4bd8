// SPDX-License-Identifier: Apache-2.0
#include "perception/pipeline/input_log.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace prospect {
namespace {

InputResult left_out(InputState state, const char* format, double seconds, double limit) {
  char text[96];
  std::snprintf(text, sizeof text, format, seconds, limit);
  return {state, text};
}

}  // namespace

std::string_view to_string(InputSource source) {
  constexpr std::string_view kNames[] = {"stereo pair", "wheels", "depth image",
                                         "scan",        "pose",   "imu"};
  return kNames[static_cast<std::size_t>(source)];
}

std::string_view to_string(InputState state) {
  constexpr std::string_view kNames[] = {"taken", "waiting", "late", "refused"};
  return kNames[static_cast<std::size_t>(state)];
}

std::optional<InputResult> InputLog::objection(InputSource source, double stamp, int sensor) {
  InputCount& own = at(source, sensor);
  const auto refuse = [&](const InputResult& why) { return note(source, why, false, sensor); };
  if (!std::isfinite(stamp)) {
    return refuse({InputState::kRefused, "the time is not a number"});
  }
  if (own.newest && !(stamp > *own.newest)) {
    return refuse(left_out(InputState::kLate, "%.3f s is not after the one before, %.3f s", stamp,
                           *own.newest));
  }
  if (newest_ && stamp < *newest_ - max_age_) {
    return refuse(left_out(InputState::kLate,
                           "%.3f s older than the newest input; expected at most %g s",
                           *newest_ - stamp, max_age_));
  }
  if (newest_ && stamp > *newest_ + max_leap_) {
    return refuse(left_out(InputState::kRefused,
                           "%.0f s ahead of the newest input; expected at most %g s, on one clock",
                           stamp - *newest_, max_leap_));
  }
  own.newest = stamp;
  newest_ = std::max(newest_.value_or(stamp), stamp);
  return std::nullopt;
}

std::optional<double> InputLog::oldest_of_more() const {
  std::map<int, double> newest;
  for (const auto& [of, count] : more_) {
    if (!count.newest) continue;
    const auto [at, first] = newest.emplace(of.first, *count.newest);
    at->second = std::max(at->second, *count.newest);
  }
  std::optional<double> oldest;
  for (const auto& [sensor, stamp] : newest) oldest = std::min(oldest.value_or(stamp), stamp);
  return oldest;
}

const InputResult& InputLog::note(InputSource source, const InputResult& result, bool has_waited,
                                  int sensor) {
  InputCount& own = at(source, sensor);
  own.waiting -= has_waited;
  own.taken += result.state == InputState::kTaken;
  own.waiting += result.state == InputState::kWaiting;
  own.late += result.state == InputState::kLate;
  own.refused += result.state == InputState::kRefused;
  if (result.state == InputState::kLate || result.state == InputState::kRefused) {
    own.reason = result.reason;
  }
  return result;
}

}  // namespace prospect
