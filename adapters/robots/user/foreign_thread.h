// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <future>
#include <stop_token>
#include <thread>

namespace prospect {

/// A thread that runs code of others, which may not come back: its end is asked for, waited for,
/// and not waited for any longer. What still runs then is left to itself.
class ForeignThread {
 public:
  static constexpr double kPatience = 1.0;  ///< [s] that its end is waited for

  /// work owns all that it touches, as it may outlive everything. What it throws is lost.
  explicit ForeignThread(std::function<void(const std::stop_token&)> work);
  ~ForeignThread();
  ForeignThread(const ForeignThread&) = delete;
  ForeignThread& operator=(const ForeignThread&) = delete;

 private:
  std::stop_source stop_;
  std::future<void> over_;
  std::thread thread_;
};

}  // namespace prospect
