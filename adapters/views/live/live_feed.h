// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "adapters/missions/run/run_observer.h"
#include "adapters/missions/run/run_record.h"
#include "engine/maps/belief.h"
#include "runtime/camera_picture.h"
#include "runtime/driver.h"
#include "runtime/event_log.h"
#include "runtime/health_report.h"

namespace prospect {

/// Where the robot is by its newest belief. Stamps in the clock of beliefs [s].
struct LivePose {
  double stamp = 0.0;
  Pose pose;
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();
  Twist twist;
  Localization localization = Localization::kOk;
};

/// What drives the robot, at one instant.
struct LiveDriver {
  DriverStatus status;
  HealthReport health;
};

inline constexpr int kLivePictureWidth = 480;  ///< [px] at most, of what viewers get

/// From the threads of a mission to the one that shows it. What comes is copied first; then a lock
/// is held for a pointer to be moved. Of poses, drivers and pictures the newest counts; all steps
/// and events are kept until they are taken, kMost at most, of which the oldest are dropped and
/// counted.
///
/// Thread-safety: as MissionObserver; the others by any thread. Nothing throws but std::bad_alloc.
class LiveFeed final : public RunObserver {
 public:
  static constexpr std::size_t kMost = 10000;

  void on_record(const StepRecord& record, const MissionStep& step) override;
  void on_belief(const Belief& belief) override;
  void on_events(std::span<const Event> events) override;
  void on_status(const DriverStatus& status, const HealthReport& health) override;
  /// Taken where somebody watches, at most five times a second.
  void on_picture(const CameraPicture& picture) override;
  void end(const Summary& summary);
  /// Whether somebody watches.
  bool wants_pictures() const;

  struct News {
    std::vector<std::shared_ptr<const StepRecord>> steps;
    std::vector<Event> events;
    // The newest of each; null: nothing new.
    std::shared_ptr<const LivePose> pose;
    std::shared_ptr<const LiveDriver> driver;
    std::shared_ptr<const CameraPicture> picture;
    std::shared_ptr<const Summary> end;
    std::uint64_t dropped = 0;  ///< steps and events, of all that have come
  };
  /// What has come since the call before. `watched`: whether pictures are wanted from now on.
  News take(bool watched);

 private:
  mutable std::mutex mutex_;
  News news_;
  bool watched_ = false;
  std::optional<std::chrono::steady_clock::time_point> picture_at_;  // of the perception thread
};

}  // namespace prospect
