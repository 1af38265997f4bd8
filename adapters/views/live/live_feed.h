#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "adapters/missions/run/run_record.h"
#include "engine/maps/belief.h"
#include "models/image.h"
#include "perception/odometry/odometry.h"
#include "runtime/event_log.h"
#include "runtime/health_report.h"
#include "runtime/real_time_driver.h"

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
  double now = 0.0;  ///< [s] of the runtime's clock
  DriverStatus status;
  HealthReport health;
};

inline constexpr int kLivePictureWidth = 480;  ///< [px] at most, of what viewers get

/// What the left camera showed.
struct LivePicture {
  Image image;
  std::vector<LandmarkSighting> sightings;
};

/// From the threads of a mission to the one that shows it. What comes is copied first; then a lock
/// is held for a pointer to be moved. Of poses, drivers and pictures the newest counts; all steps
/// and events are kept until they are taken, kMost at most, of which the oldest are dropped and
/// counted.
///
/// Thread-safety: each function by one thread at a time, all of them at the same time. Nothing
/// throws but std::bad_alloc.
class LiveFeed {
 public:
  static constexpr std::size_t kMost = 10000;

  void step(const StepRecord& step);
  void belief(const Belief& belief);
  /// Asks the driver at most five times a second; `now` [s] of the runtime's clock.
  void driver(const RealTimeDriver& driver, double now);
  /// Taken where somebody watches, at most five times a second.
  void picture(const Image& left, const std::vector<LandmarkSighting>& sightings);
  void end(const Summary& summary);
  /// Whether somebody watches.
  bool wants_pictures() const;

  struct News {
    std::vector<std::shared_ptr<const StepRecord>> steps;
    std::vector<Event> events;
    // The newest of each; null: nothing new.
    std::shared_ptr<const LivePose> pose;
    std::shared_ptr<const LiveDriver> driver;
    std::shared_ptr<const LivePicture> picture;
    std::shared_ptr<const Summary> end;
    std::uint64_t dropped = 0;  ///< steps and events, of all that have come
  };
  /// What has come since the call before. `watched`: whether pictures are wanted from now on.
  News take(bool watched);

 private:
  mutable std::mutex mutex_;
  News news_;
  bool watched_ = false;
  // Each of one thread.
  std::optional<std::chrono::steady_clock::time_point> picture_at_, driver_at_;
  std::uint64_t next_event_ = 0;
};

}  // namespace prospect
