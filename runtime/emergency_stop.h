// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <span>
#include <string>
#include <vector>

namespace prospect {

/// What is expected of those who may press an emergency stop, so that their absence is noticed.
struct EmergencyStopContract {
  int publishers = 1;    ///< so many at least must be there, each with a word of its own
  double max_age = 1.0;  ///< [s] of the newest word of each
  /// Each says it once and again when it changes; that it is there is told by what carries its
  /// word (set_present()), and max_age is not looked at.
  bool latched = false;
};

/// What is known of an emergency stop at one instant.
struct EmergencyStopState {
  bool pressed = false;
  std::string silent;  ///< why nobody is heard of who could press it; empty: somebody is
};

/// An emergency stop that others press: a button's thread, topics. A wire that is cut says nothing:
/// so silence counts, too. It is pressed while any of them says so, and silent while fewer than
/// contract.publishers are there and have said whether it is. Who is too old is not there.
///
/// Thread-safety: any thread; nobody waits but for a lock that is held for a copy. Errors: the
/// constructor throws std::invalid_argument for a contract that cannot be kept watch over: fewer
/// than one publisher, or no finite age > 0.
class EmergencyStopInput {
 public:
  explicit EmergencyStopInput(std::string name, const EmergencyStopContract& contract = {});

  /// One of them says whether it presses, at `now` [s] of the runtime's clock. publisher: tells
  /// them apart.
  void told(std::uint64_t publisher, bool pressed, double now);
  /// All that are there at `now`, which is asked where the contract is a latched one. Until then
  /// nobody. One look that misses somebody decides nothing: who was there 0.2 s ago is there.
  void set_present(std::span<const std::uint64_t> publishers, double now);
  EmergencyStopState state(double now) const;
  const std::string& name() const { return name_; }

 private:
  struct Word {
    double stamp = 0.0;
    bool pressed = false;
  };
  const std::string name_;
  const EmergencyStopContract contract_;
  mutable std::mutex mutex_;
  std::map<std::uint64_t, Word> words_;      // the newest of each
  std::map<std::uint64_t, double> present_;  // [s] when each was there
};

}  // namespace prospect
