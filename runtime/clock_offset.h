// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace prospect {

class Knobs;

struct ClockOffsetOptions {
  /// The source has a clock of its own, and the offset is estimated. Else its stamps are of the
  /// runtime's clock, and the offset is zero.
  bool own_clock = true;
  double drift = 1e-4;       ///< most that one clock runs faster than the other [s/s]
  double jump = 0.1;         ///< [s] what is off by more is no drift and no delay
  int settle_count = 5;      ///< stamps, and ...
  double settle_time = 0.5;  ///< ... seconds, before a new estimate is used
  double least_delay = 0.0;  ///< [s] from capture to arrival of the quickest message, if known
};
/// The knobs (models/knobs.h).
void describe(Knobs& knobs, ClockOffsetOptions& options);

enum class StampVerdict {
  kGood,
  kDelayed,   ///< it came later than the quickest by more than `jump`; good else
  kSettling,  ///< too little is known of the offset yet
  kSuspect,   ///< off by more than `jump`; the next stamp tells whether a clock has jumped
  kJumped,    ///< a clock has jumped: the estimate begins anew
  kFuture,    ///< ahead of the runtime's clock, which it is of
  kInvalid    ///< not finite
};
/// "good", "delayed", "settling", "suspect", "jumped", "future", "invalid".
std::string_view to_string(StampVerdict verdict);

/// What a stamp says in the runtime's clock.
struct StampReading {
  StampVerdict verdict = StampVerdict::kInvalid;
  /// [s] in the runtime's monotonic clock, never later than the arrival. Only if kGood or kDelayed:
  /// a source without a time counts as not live.
  std::optional<double> time;
  double delay = 0.0;  ///< [s] arrival - time, if there is one
  double jump = 0.0;   ///< [s] that the source's clock went ahead of the runtime's, if kJumped
  std::string text;    ///< of all but kGood: what was wrong, with numbers
};

/// The offset between a source's stamps and the runtime's monotonic clock: time = stamp + offset.
///
/// A message stamped s that arrives at r was under way for d = r - s - offset >= 0. So each bounds
/// the offset from above by r - s, and the quickest bounds it best. With clocks that drift by no
/// more than `drift`,
///   offset <- min(r - s, offset + drift (r - r_before))
/// (Olson 2010, A passive solution to the sensor synchronization problem). What all messages have
/// in common of their delay cannot be seen: `least_delay` states it. Times are up to that too late,
/// never later than the arrival.
///
/// Jumps. A stamp that lies more than `jump` before the one before it, or that would have come more
/// than `jump` quicker than the quickest, is set aside as suspect. If the next one agrees with it
/// within `jump`, a clock has jumped, and the estimate begins anew from both. If it does not, the
/// one alone was wrong, or out of order, and nothing is changed. So a jump costs two stamps and the
/// time to settle, whatever its size and direction, and not its own length. A runtime's clock that
/// goes back by more than `jump` is a jump as well.
///
/// A step back that is less than `jump`, or one across a pause that is longer than the step, looks
/// like messages that are slower. It is taken for that: times are too old by the step, so what
/// checks ages is on the safe side. The verdict is kDelayed beyond `jump`. Whoever knows better
/// calls reset().
///
/// Source on the runtime's clock: time = stamp. Ahead of the arrival by more than a millisecond it
/// has no time.
///
/// Memory: two stamps. Thread-safety: one thread at a time. Errors: the constructor throws
/// std::invalid_argument for options out of range; add() takes any numbers.
class ClockOffset {
 public:
  explicit ClockOffset(const ClockOffsetOptions& options = {});

  /// stamp [s] in the source's clock, arrival [s] in the runtime's.
  StampReading add(double stamp, double arrival);
  /// Begins anew with the next stamp.
  void reset() { before_.reset(), suspect_.reset(); }

  /// [s]; none until it has settled.
  std::optional<double> offset() const;
  bool has_own_clock() const { return options_.own_clock; }
  int jumps() const { return jumps_; }      ///< since the start
  int refused() const { return refused_; }  ///< stamps that got no time, but for settling

 private:
  struct Sample {
    double stamp, arrival;
    double difference() const { return arrival - stamp; }
  };
  void begin(const Sample& sample);
  bool settled() const;
  StampReading refused(StampVerdict verdict, std::string text);

  ClockOffsetOptions options_;
  std::optional<Sample> before_;   // the newest that was taken
  std::optional<Sample> suspect_;  // the one before, if it was set aside
  double offset_ = 0.0;            // with before_: the least difference, and drift since
  double begun_ = 0.0;             // [s] arrival of the first
  int taken_ = 0;                  // since then
  int jumps_ = 0, refused_ = 0;
};

}  // namespace prospect
