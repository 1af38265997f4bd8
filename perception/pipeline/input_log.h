// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace prospect {

enum class InputSource { kStereo, kWheels, kDepth, kScan, kPose, kImu };
std::string_view to_string(InputSource source);

/// What became of one input.
enum class InputState {
  kTaken,    ///< worked in
  kWaiting,  ///< kept until the pose of its time is known
  kLate,     ///< left out: older than the limit, or not newer than the one before of its source
  kRefused   ///< left out: it cannot be used
};
std::string_view to_string(InputState state);

struct InputResult {
  InputState state = InputState::kTaken;
  std::string reason;  ///< why it was left out or is of less use; empty: nothing is to be said
};

/// What became of the inputs of one source.
struct InputCount {
  std::optional<double> newest;  ///< stamp of the newest that came in order [s], whatever it held
  std::uint64_t taken = 0, waiting = 0, late = 0, refused = 0;
  std::string reason;  ///< why the newest that was left out was
};

/// Judges stamps and counts what becomes of inputs. The sources have one clock. Each depth sensor
/// is a source of its own, by its number. Thread-safety: one thread. Never throws. Deterministic.
class InputLog {
 public:
  /// Of an input against the newest of all sources [s]: max_age, how far it may be behind, and
  /// max_leap, how far ahead.
  explicit InputLog(double max_age, double max_leap = 3600.0)
      : max_age_(max_age), max_leap_(max_leap) {}

  /// Whether an input may be looked at: its stamp is finite, newer than the one before of its
  /// source, and neither too old nor too far ahead. Then it is the newest of
  /// its source from now on. Otherwise it is counted as left out, and what to say is returned.
  std::optional<InputResult> objection(InputSource source, double stamp, int sensor = 0);
  /// Counts what became of an input; one that waits is counted again when it no longer does.
  const InputResult& note(InputSource source, const InputResult& result, bool has_waited = false,
                          int sensor = 0);

  const InputCount& count(InputSource source) const { return counts_[index(source)]; }
  /// Of depth sensors besides the first: the stamp up to which each of them has been heard of, of
  /// the one that is farthest behind; none: there is none, or nothing has come.
  std::optional<double> oldest_of_more() const;

 private:
  InputCount& at(InputSource source, int sensor) {
    return sensor == 0 ? counts_[index(source)] : more_[{sensor, source}];
  }
  static std::size_t index(InputSource source) { return static_cast<std::size_t>(source); }

  double max_age_, max_leap_;
  std::array<InputCount, 6> counts_;
  std::map<std::pair<int, InputSource>, InputCount> more_;  // of sensors from 1 on
  std::optional<double> newest_;                            // of all
};

}  // namespace prospect
