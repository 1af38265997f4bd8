#pragma once

#include <Eigen/Core>
#include <atomic>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

namespace prospect {

/// What people ask of a robot while a mission drives it. The mission's driver looks at each command
/// and each planning step what is asked for.
///
/// Thread-safety: all functions may be called at the same time, by any thread. None waits but for a
/// lock that is held for a copy of two numbers or a sentence. Nothing throws but std::bad_alloc.
class DriveRequests {
 public:
  /// To brake and stand, and to drive on with a new plan.
  void hold() noexcept { told_to_drive_ = false; }
  void resume() noexcept { told_to_drive_ = true; }
  bool told_to_drive() const noexcept { return told_to_drive_; }

  /// Latches: answered by the next command. Once the robot has stopped and nothing is wrong any
  /// more, acknowledge() lets it go on; before that it has no effect.
  void emergency_stop() noexcept { emergency_stop_ = true; }
  void acknowledge() noexcept { acknowledged_ = true; }
  /// Asked for, and not yet seen by take_emergency_stop().
  bool emergency_stop_waits() const noexcept { return emergency_stop_; }

  /// To a place in W [m], in the middle of the task, also after hold(). What was asked for before
  /// and has not been taken is forgotten. There, or if no way leads there, the robot stands as
  /// after hold(); resume() goes on with the task. A place that the planner refuses changes
  /// nothing.
  void go_to(const Eigen::Vector2d& place) noexcept {
    const std::lock_guard lock(mutex_);
    place_ = place;
    told_.clear();
  }

  /// A stop is latched, which waits for acknowledge().
  bool stopped() const noexcept { return stopped_; }
  /// What became of the newest place, a sentence; empty: nothing yet.
  std::string told() const {
    const std::lock_guard lock(mutex_);
    return told_;
  }

  // For the driver: whether it was asked for since the call before.
  bool take_emergency_stop() noexcept { return emergency_stop_.exchange(false); }
  bool take_acknowledgement() noexcept { return acknowledged_.exchange(false); }
  std::optional<Eigen::Vector2d> take_place() noexcept {
    const std::lock_guard lock(mutex_);
    std::optional<Eigen::Vector2d> place;
    place.swap(place_);
    return place;
  }
  void set_stopped(bool stopped) noexcept { stopped_ = stopped; }
  void tell(std::string what) {
    const std::lock_guard lock(mutex_);
    told_ = std::move(what);
  }

 private:
  std::atomic<bool> told_to_drive_{true}, emergency_stop_{false}, acknowledged_{false},
      stopped_{false};
  mutable std::mutex mutex_;
  std::optional<Eigen::Vector2d> place_;
  std::string told_;
};

}  // namespace prospect
