// SPDX-License-Identifier: Apache-2.0
#include "runtime/clock_offset.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "models/formatted.h"
#include "models/knobs.h"

namespace prospect {
namespace {

constexpr double kFuture = 1e-3;  // [s] that a stamp may be ahead of a clock that is read twice

}  // namespace

std::string_view to_string(StampVerdict verdict) {
  switch (verdict) {
    case StampVerdict::kGood:
      return "good";
    case StampVerdict::kDelayed:
      return "delayed";
    case StampVerdict::kSettling:
      return "settling";
    case StampVerdict::kSuspect:
      return "suspect";
    case StampVerdict::kJumped:
      return "jumped";
    case StampVerdict::kFuture:
      return "future";
    case StampVerdict::kInvalid:
      return "invalid";
  }
  return "?";
}

ClockOffset::ClockOffset(const ClockOffsetOptions& options) : options_(options) {
  check_knobs("clock offset", options_);
}

void ClockOffset::begin(const Sample& sample) {
  before_ = sample;
  suspect_.reset();
  offset_ = sample.difference();
  begun_ = sample.arrival;
  taken_ = 1;
}

bool ClockOffset::settled() const {
  return before_ && taken_ >= options_.settle_count &&
         before_->arrival - begun_ >= options_.settle_time;
}

std::optional<double> ClockOffset::offset() const {
  if (!options_.own_clock) return 0.0;
  if (!settled()) return std::nullopt;
  return offset_ - options_.least_delay;
}

StampReading ClockOffset::refused(StampVerdict verdict, std::string text) {
  ++refused_;
  StampReading reading;
  reading.verdict = verdict;
  reading.text = std::move(text);
  return reading;
}

StampReading ClockOffset::add(double stamp, double arrival) {
  if (!std::isfinite(stamp) || !std::isfinite(arrival)) {
    return refused(StampVerdict::kInvalid,
                   formatted("stamp %g is not finite", std::isfinite(stamp) ? arrival : stamp));
  }
  const Sample sample{stamp, arrival};
  StampReading reading;
  if (!options_.own_clock) {
    if (sample.difference() < -kFuture) {
      return refused(StampVerdict::kFuture,
                     formatted("%.3g s ahead of the runtime's clock", -sample.difference()));
    }
    reading.verdict = StampVerdict::kGood;
    reading.time = std::min(stamp, arrival);
    reading.delay = arrival - *reading.time;
    return reading;
  }
  if (!before_) {
    begin(sample);
  } else {
    const double since = arrival - before_->arrival;
    const double grown = offset_ + options_.drift * std::max(0.0, since);
    // All of these are about the source's clock against the runtime's: which of both jumped, no
    // stamp tells.
    const double ahead = grown - sample.difference();
    const bool back = before_->stamp - stamp > options_.jump || since < -options_.jump;
    if (ahead > options_.jump || back) {
      const bool agrees = suspect_ &&
                          std::abs(sample.difference() - suspect_->difference()) <= options_.jump &&
                          suspect_->stamp - stamp <= options_.jump;
      if (!agrees) {
        suspect_ = sample;
        return refused(StampVerdict::kSuspect,
                       formatted(ahead > options_.jump ? "ahead of the stamps before by %.3g s"
                                                       : "behind the stamps before by %.3g s",
                                 std::abs(ahead)));
      }
      const double least = std::min(sample.difference(), suspect_->difference());
      const double jump = offset_ - least;
      const double begun = suspect_->arrival;
      begin(sample);
      offset_ = least;
      begun_ = begun;
      taken_ = 2;
      ++jumps_;
      reading = refused(
          StampVerdict::kJumped,
          formatted(jump > 0.0 ? "the source's clock went ahead by %.3g s against the runtime's"
                               : "the source's clock went back by %.3g s against the runtime's",
                    std::abs(jump)));
      reading.jump = jump;
      return reading;
    }
    suspect_.reset();
    offset_ = std::min(sample.difference(), grown);
    // Out of order by less than `jump`: the newest stays the one to compare with.
    before_ = Sample{std::max(stamp, before_->stamp), std::max(arrival, before_->arrival)};
    ++taken_;
  }
  if (!settled()) {
    reading.verdict = StampVerdict::kSettling;
    reading.text = formatted("%d stamps since the estimate began", taken_);
    return reading;
  }
  // The minimum is for rounding: stamps of a calendar have a resolution of 0.2 us.
  reading.time = std::min(arrival, stamp + offset_ - options_.least_delay);
  reading.delay = arrival - *reading.time;
  reading.verdict = StampVerdict::kGood;
  if (reading.delay - options_.least_delay > options_.jump) {
    reading.verdict = StampVerdict::kDelayed;
    reading.text = formatted("%.3g s later than the quickest, or its clock was set back",
                             reading.delay - options_.least_delay);
  }
  return reading;
}

}  // namespace prospect
