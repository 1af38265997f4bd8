// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

namespace prospect {

/// For as long as it lives, code of others is at work on this thread: a plug-in's entry, what makes
/// a robot's drivers. If that has not come back in time, a line on standard error says so and the
/// process ends with code 1: nothing drives by then, the code cannot be taken back, and it may
/// hold any lock, so nothing is destroyed and no file is written.
class ReturnDeadline {
 public:
  static constexpr double kEntryPatience = 10.0;  ///< [s] of a plug-in's entry and describe()
  static constexpr double kMakePatience = 60.0;   ///< [s] of UserRobot::make: hardware starts up

  /// what: "plug-in 'lib.so': its entry".
  ReturnDeadline(std::string what, double seconds);
  ~ReturnDeadline();
  ReturnDeadline(const ReturnDeadline&) = delete;
  ReturnDeadline& operator=(const ReturnDeadline&) = delete;

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool back_ = false;
  std::thread thread_;
};

}  // namespace prospect
