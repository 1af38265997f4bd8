// SPDX-License-Identifier: Apache-2.0
#include "runtime/drive_watch.h"

#include <algorithm>
#include <cmath>

#include "models/knobs.h"

namespace prospect {
namespace {

/// For how long it has been so [s].
double lasting(bool so, double now, std::optional<double>& since) {
  if (!so) {
    since.reset();
    return 0.0;
  }
  if (!since) since = now;
  return now - *since;
}

}  // namespace

DriveWatch::DriveWatch(const DriveWatchOptions& options) : options_(options) {
  check_knobs("drive watch", options_);
}

DriveFacts DriveWatch::facts(const DriveObservation& seen) {
  const double now = seen.now;
  const BaseReport& base = *seen.base;
  DriveFacts facts;
  facts.stamp = now;
  facts.told_to_drive = seen.told_to_drive;
  facts.emergency_stop = seen.emergency_stop;
  facts.silent_emergency_stop = seen.silent_emergency_stop;
  facts.not_following = seen.not_following;
  facts.acknowledged = seen.acknowledged;
  facts.task_over = seen.task_over;
  facts.failed_preflight = seen.failed_preflight;
  facts.yaw_checked = seen.yaw_checked;
  facts.plan_from_rest = seen.plan_from_rest;
  facts.plan_left = seen.plan_left;
  facts.obstacle = seen.obstacle;
  facts.jumped_clock = seen.jumped_clock;
  facts.jumped_pose = seen.jumped_pose;

  const bool is_new = base.connected && heard_ != base.stamp;
  if (is_new) heard_ = base.stamp;
  // A stamp that is ahead of time says as little as an old one.
  facts.base_silent = !heard_ || !(std::abs(now - *heard_) <= options_.max_silence);
  if (!base.faults.empty()) facts.base_fault = base.faults.front();
  const double speed = base.velocity.linear.norm(), rate = std::abs(base.velocity.yaw_rate);
  facts.rest_for = lasting(base.connected && !facts.base_silent && speed <= options_.rest_speed &&
                               rate <= options_.rest_rate,
                           now, resting_since_);
  double told_speed = 0.0, told_rate = 0.0;
  for (std::size_t k = 0; k < seen.sent.size(); ++k) {
    const bool newest = k + 1 == seen.sent.size();
    if (!newest && seen.sent[k + 1].time < now - options_.settle_time) continue;
    told_speed = std::max(told_speed, seen.sent[k].command.linear.norm());
    told_rate = std::max(told_rate, std::abs(seen.sent[k].command.yaw_rate));
  }
  const bool strays = base.connected && (!(speed <= told_speed + options_.stray_speed) ||
                                         !(rate <= told_rate + options_.stray_rate));
  if (is_new) strays ? straying_.bad("it strays") : straying_.good();
  facts.uncommanded_motion =
      lasting(strays, now, straying_since_) >= options_.stray_time && straying_.is_bad();

  facts.stale_source = seen.belief ? seen.stale_source : "no belief yet";
  facts.live_for = lasting(facts.stale_source.empty() && !facts.base_silent, now, live_since_);
  facts.localization = seen.belief ? seen.belief->localization : Localization::kLost;
  facts.localized_for = lasting(facts.localization == Localization::kOk, now, localized_since_);

  for (const ThreadReport& thread : seen.threads) {
    if (thread.state == ThreadState::kEnded) facts.ended_thread = thread.name;
    if (thread.state == ThreadState::kLate || thread.state == ThreadState::kNeverStarted) {
      facts.late_thread = thread.name;
    }
  }
  return facts;
}

}  // namespace prospect
