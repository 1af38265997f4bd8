// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/maps/belief.h"
#include "runtime/base.h"
#include "runtime/drive_mode.h"
#include "runtime/predicted_belief.h"
#include "runtime/sample_judge.h"
#include "runtime/supervisor.h"

namespace prospect {

class Knobs;

struct DriveWatchOptions {
  double max_silence = 0.5;   ///< [s] since the base's newest report
  double rest_speed = 0.02;   ///< [m/s] below which the base is at rest
  double rest_rate = 0.05;    ///< [rad/s]
  double stray_speed = 0.25;  ///< [m/s] by which it may move faster than it is told to
  double stray_rate = 0.6;    ///< [rad/s]
  double stray_time = 0.4;    ///< [s] of it that are no noise
  double settle_time = 1.0;   ///< [s] for which a command counts after it was replaced
};

/// The knobs (models/knobs.h).
void describe(Knobs& knobs, DriveWatchOptions& options);

/// What the command thread sees at one instant.
struct DriveObservation {
  double now = 0.0;                   ///< [s]
  const Belief* belief = nullptr;     ///< the newest; null: none yet
  std::string stale_source;           ///< Guard::stale_source() of it
  const BaseReport* base = nullptr;   ///< never null
  std::span<const SentCommand> sent;  ///< oldest first
  std::vector<ThreadReport> threads;
  std::optional<double> plan_from_rest;   ///< DriveFacts
  double plan_left = 0.0;                 ///< DriveFacts
  std::string obstacle;                   ///< DriveFacts
  std::string jumped_clock, jumped_pose;  ///< DriveFacts
  bool told_to_drive = false, emergency_stop = false, acknowledged = false, task_over = false;
  std::string silent_emergency_stop = DriveFacts().silent_emergency_stop;
  std::string not_following;  ///< DriveFacts
  std::string failed_preflight;
  bool yaw_checked = false;
};

/// Turns what is seen into the facts that the table of drive modes reads (drive_mode.h): it
/// remembers since when what is so has been so. No judgement of its own, but for what counts as
/// rest, as silence and as motion that nobody has asked for:
///   the base strays if it measures a velocity that exceeds the largest of the commands of the last
///   settle_time by stray_speed or stray_rate, for stray_time and in several of its reports;
///   it is silent if no report of one that is connected came for max_silence.
/// One bad report decides nothing (sample_judge.h).
/// Thread-safety: one thread. The constructor throws std::invalid_argument on options out of range.
class DriveWatch {
 public:
  explicit DriveWatch(const DriveWatchOptions& options = {});
  DriveFacts facts(const DriveObservation& seen);

 private:
  DriveWatchOptions options_;
  std::optional<double> resting_since_, live_since_, localized_since_, straying_since_;
  std::optional<double> heard_;  // [s] stamp of the newest report of a base that is connected
  SampleJudge straying_;         // of its reports
};

}  // namespace prospect
