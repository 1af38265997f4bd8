// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <atomic>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace prospect {

/// What became of a place that people have asked for.
enum class DetourState { kNone, kAsked, kOnTheWay, kThere, kNotThere, kRefused, kCancelled };
struct Detour {
  int number = 0;  ///< of DriveRequests::go_to(); 0: none was asked for
  DetourState state = DetourState::kNone;
  std::string why;  ///< a sentence, once it is over
};
/// A sentence of what became of a place, for the record.
struct RequestNote {
  bool bad = false;  ///< the robot does not get there
  std::string text;
};

/// What people ask of a robot while a mission drives it. The mission's driver looks at each command
/// and each planning step what is asked for.
///
/// Thread-safety: all functions may be called at the same time, by any thread. None waits but for a
/// lock that is held for a copy of two numbers or a sentence. Nothing throws but std::bad_alloc.
class DriveRequests {
 public:
  struct Place {
    int number;                 ///< of go_to()
    Eigen::Vector2d position;   ///< in W [m]
    std::optional<double> yaw;  ///< [rad]; none: any heading
  };

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

  /// To a place in W [m], with a heading [rad] if one is given, in the middle of the task, also
  /// after hold(). What was asked for before is forgotten. There, or if no way leads there, the
  /// robot stands as after hold(); resume() goes on with the task. A place that the planner refuses
  /// changes nothing. Its number, from 1 on.
  int go_to(const Eigen::Vector2d& place, std::optional<double> yaw = std::nullopt) noexcept {
    const std::lock_guard lock(mutex_);
    asked_ = {asked_.number + 1, DetourState::kAsked, {}};
    place_ = Place{asked_.number, place, yaw};
    told_.clear();
    return asked_.number;
  }
  /// To give up the place that it drives to, and one that waits, and to stand as after hold().
  /// False: there is none.
  bool cancel() {
    const std::lock_guard lock(mutex_);
    if (place_) {
      asked_.state = DetourState::kCancelled;
      place_.reset();
    } else if (driven_.state != DetourState::kOnTheWay) {
      return false;
    }
    cancel_ = driven_.state == DetourState::kOnTheWay;
    told_to_drive_ = false;
    return true;
  }
  /// Of a place that who heard of it refuses, for people: a sentence. It changes nothing else.
  void refuse(std::string why) {
    const std::lock_guard lock(mutex_);
    told_ = std::move(why);
    told_refused_ = true;
    note();
  }

  /// A stop is latched, which waits for acknowledge().
  bool stopped() const noexcept { return stopped_; }
  /// What became of the newest place, a sentence; empty: nothing yet.
  std::string told() const {
    const std::lock_guard lock(mutex_);
    return told_;
  }
  /// Whether that is a refusal, or that it does not get there.
  bool told_refused() const {
    const std::lock_guard lock(mutex_);
    return told_refused_;
  }
  /// The newest place that was asked for, and that of a number.
  Detour detour() const {
    const std::lock_guard lock(mutex_);
    return asked_;
  }
  Detour detour(int number) const {
    const std::lock_guard lock(mutex_);
    for (const Detour& known : {driven_, asked_}) {
      if (known.number == number) return known;
    }
    return {number, DetourState::kNotThere, "another place was asked for"};
  }

  // For the driver: whether it was asked for since the call before.
  bool take_emergency_stop() noexcept { return emergency_stop_.exchange(false); }
  bool take_acknowledgement() noexcept { return acknowledged_.exchange(false); }
  std::optional<Place> take_place() noexcept {
    const std::lock_guard lock(mutex_);
    std::optional<Place> place;
    place.swap(place_);
    return place;
  }
  bool take_cancellation() noexcept {
    const std::lock_guard lock(mutex_);
    return std::exchange(cancel_, false);
  }
  /// What became of a place that was taken.
  void tell(const Detour& detour) {
    const std::lock_guard lock(mutex_);
    if (detour.number == asked_.number) asked_ = detour;
    if (detour.number == driven_.number || detour.state == DetourState::kOnTheWay) driven_ = detour;
    told_ = detour.why;
    told_refused_ = detour.state == DetourState::kNotThere || detour.state == DetourState::kRefused;
    note();
  }
  /// What is to be noted of places, of those not yet taken the newest ten.
  std::vector<RequestNote> take_notes() {
    const std::lock_guard lock(mutex_);
    return std::exchange(notes_, {});
  }
  void set_stopped(bool stopped) noexcept { stopped_ = stopped; }

 private:
  void note() {
    constexpr std::size_t kMost = 10;
    if (told_.empty()) return;
    if (notes_.size() == kMost) notes_.erase(notes_.begin());
    notes_.push_back({told_refused_, told_});
  }

  std::atomic<bool> told_to_drive_{true}, emergency_stop_{false}, acknowledged_{false},
      stopped_{false};
  mutable std::mutex mutex_;
  std::optional<Place> place_;
  bool cancel_ = false;
  Detour asked_, driven_;  // the newest; that which the robot was last on the way to
  std::string told_;
  bool told_refused_ = false;
  std::vector<RequestNote> notes_;
};

}  // namespace prospect
